(Range right of Range offset along Range by Range[: Range])
