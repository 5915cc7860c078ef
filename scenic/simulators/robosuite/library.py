"""The package robosuite, which is optional: imported when a simulation is made. It has no types, hence `Any`."""

from collections.abc import Callable
from functools import lru_cache
from typing import Any

from scenic.language.errors import UnsupportedError
from scenic.language.extras import installation
from scenic.simulators.mujoco.library import draw_without_window

__all__ = ["environment_class", "library"]


def library() -> Any:
    """Return the module ``robosuite``; raises `UnsupportedError` without it."""
    draw_without_window()
    try:
        import robosuite  # optional, and slow to import
        from robosuite.utils.log_utils import ROBOSUITE_DEFAULT_LOGGER
    except ImportError as error:
        raise UnsupportedError(
            f"simulating with robosuite needs the package robosuite ({error})",
            help="install it in an environment of its own, since it needs an old MuJoCo: "
            f"{installation('robosuite')}; pip install --no-deps robosuite==1.5.2",
        ) from error
    ROBOSUITE_DEFAULT_LOGGER.setLevel("ERROR")
    return robosuite


@lru_cache(maxsize=1)
def environment_class() -> Any:
    """Return the class of environments whose content is built by a function, and which have no task.

    Its argument ``build`` is called with the environment's robots when the model is made, and returns arena and objects. Its
    argument ``place`` is called with the environment at each reset.
    """
    library()
    from robosuite.environments.manipulation.manipulation_env import ManipulationEnv
    from robosuite.models.tasks import ManipulationTask

    class SceneEnvironment(ManipulationEnv):  # type: ignore[misc] # a class that is known when it runs
        """An environment without a task."""

        def __init__(
            self,
            *,
            build: Callable[[Any], tuple[Any, list[Any]]],
            place: Callable[[Any], None],
            robot_configs: list[dict[str, Any]],
            **settings: Any,
        ) -> None:
            self._build = build
            self._place = place
            self._own_configs = robot_configs
            super().__init__(**settings)

        def reward(self, action: object = None) -> float:
            """Zero: there is no task."""
            return 0.0

        def _check_success(self) -> bool:
            return False

        def _load_robots(self) -> None:
            for config, own in zip(self.robot_configs, self._own_configs, strict=True):
                config.update(own)
            super()._load_robots()

        def _load_model(self) -> None:
            super()._load_model()
            arena, objects = self._build([robot.robot_model for robot in self.robots])
            models = [robot.robot_model for robot in self.robots]
            self.model = ManipulationTask(mujoco_arena=arena, mujoco_robots=models, mujoco_objects=objects)

        def _reset_internal(self) -> None:
            super()._reset_internal()
            self._place(self)

    return SceneEnvironment
