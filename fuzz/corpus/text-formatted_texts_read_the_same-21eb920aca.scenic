behavior B():
    𝐩recondition: 3
    wait
