require Range and None * {x := Range for x in Range} implies Range
