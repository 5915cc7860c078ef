"""The methods of scenarios that give scenes as data, and read them."""

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import ClassVar

from scenic.graph.batch import Batch
from scenic.language.errors import SerializationError
from scenic.runtime.description.outcome import Program
from scenic.runtime.sampling.check_planning import Outline
from scenic.runtime.scenes.pickled_values import RecalledBatch
from scenic.runtime.scenes.sampler import Sampler
from scenic.runtime.scenes.saving import SavedScene, draws_of, source_of
from scenic.runtime.scenes.scene import Scene, SceneFamily

__all__ = ["Restoring"]


class Restoring:
    """Base of scenarios: `sceneToBytes` and what reads its data."""

    outline: Outline
    _program: Program
    _sampler: Sampler
    _family: SceneFamily
    scene_class: ClassVar[type[Scene]] = Scene
    """The class of its scenes."""

    def sceneToBytes(self, scene: Scene, allowPickle: bool = False) -> bytes:
        """Return a scene as data, which `sceneFromBytes` reads. ``allowPickle`` is accepted for compatibility."""
        numbers, words = draws_of(scene.found, scene.lane)
        return SavedScene(
            scene.digest, scene.found.task(scene.lane), scene.attempts, numbers, words
        ).to_bytes()

    def sceneFromBytes(self, data: bytes, verify: bool = True, allowPickle: bool = False) -> Scene:
        """Return the scene in the data of `sceneToBytes`, exactly as it was.

        Raises:
            SerializationError: if the data is damaged, or of another program (not checked if ``verify`` is false).

        """
        return self._taken_up(SavedScene.from_bytes(data), Batch, verify=verify)

    def recalled(self, data: bytes, values: bytes) -> Scene:
        """Return the scene in the data of `sceneToBytes`, with values that its layout has packed; raises as `sceneFromBytes`."""
        known = self._family.layout.unpack(values)
        kind = partial(RecalledBatch, values=known, guard=self._program.undisturbed)
        return self._taken_up(SavedScene.from_bytes(data), kind)

    def _taken_up(self, saved: SavedScene, kind: Callable[..., Batch], *, verify: bool = True) -> Scene:
        if verify and saved.program != self._family.digest():
            raise SerializationError(
                "the saved scene is of another program",
                help="load the program, parameters and options with which it was saved",
            )
        source = source_of(saved, self.outline.graph)
        with self._program.undisturbed():
            accepted = self._sampler.engine.replay(source, saved.task, saved.attempts, kind)
        return self.scene_class(*accepted, self._family)

    def replay(self, path: str | Path) -> Scene:
        """Return the scene that `Scene.save` has written; raises `SerializationError` as `sceneFromBytes` does."""
        return self.sceneFromBytes(Path(path).read_bytes())
