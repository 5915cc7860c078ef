require x as "𝐱"
