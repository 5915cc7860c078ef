"""LGSVL's simulator by its established name; it is discontinued."""

from typing import Any

from scenic.simulators.absent.placeholder import AbsentSimulator

__all__ = ["LGSVLSimulator"]


class LGSVLSimulator(AbsentSimulator):
    """Stands for LGSVL; the arguments are accepted for compatibility."""

    def __init__(self, sceneID: object = None, *_: Any, **__: Any) -> None:
        super().__init__(
            "LGSVL", "it is discontinued, and would need its server, its maps and the package lgsvl"
        )
        self.sceneID = sceneID
