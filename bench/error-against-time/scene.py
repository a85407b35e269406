"""The scenes, read by nothing of energywave: sources as arrays, rays in float64, and what the light truly is.

A pixel is the integral of the sum of coefficient * colour * 1/q^2 (or 1/q) along its ray, q^2 = distance^2 + radius^2,
over the length of the ray or over its parameter s; a decay is alpha / (s + beta)^2.
"""

import tomllib
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

HERE = Path(__file__).parent


def unit(vector):
    return vector / np.linalg.norm(vector)


@dataclass
class Sources:
    """Sources of one kind: `shape` has what the kind needs, a row each."""

    shape: np.ndarray
    color: np.ndarray  # times coefficient
    radius: np.ndarray
    is_squared: np.ndarray  # 1/q^2, or 1/q


@dataclass
class Scene:
    name: str
    path: Path
    width: int
    height: int
    measures_length: bool
    decay: tuple[float, float] | None
    ray_length: float
    camera: dict
    kinds: dict[str, Sources] = field(default_factory=dict)

    @classmethod
    def open(cls, name: str) -> "Scene":
        path = HERE / "scenes" / f"{name}.toml"
        tables = tomllib.loads(path.read_text())
        camera, image = tables["camera"], tables["image"]
        decay = tables.get("decay")
        scene = cls(
            name,
            path,
            image["width"],
            image["height"],
            tables["integration"]["measure"] == "length",
            (decay["alpha"], decay["beta"]) if decay else None,
            camera["ray_length"],
            camera,
        )
        shapes = {
            "sphere": lambda it: [*it["center"]],
            "segment": lambda it: [*it["from"], *it["to"]],
            "torus": lambda it: [
                *it.get("center", [0, 0, 0]),
                *unit(np.array(it.get("axis", [0.0, 0.0, 1.0]))),
                it["major_radius"],
            ],
        }
        for kind, shape in shapes.items():
            rows = tables.get(kind, [])
            if rows:
                scene.kinds[kind] = Sources(
                    np.array([shape(it) for it in rows], dtype=float),
                    np.array([np.multiply(it["color"], it["coefficient"]) for it in rows], dtype=float),
                    np.array([it.get("radius", 0.0) for it in rows]),
                    np.array([it.get("profile", "inverse-square") == "inverse-square" for it in rows]),
                )
        return scene

    def rays(self) -> tuple[np.ndarray, np.ndarray]:
        """Returns where the rays of all pixels begin, by rows from the top left, and their directions of length 1."""
        eye, target, up = (np.array(self.camera[key], dtype=float) for key in ("eye", "target", "up"))
        forward = unit(target - eye)
        right = unit(np.cross(forward, up))
        above = np.cross(right, forward)
        near = self.camera["near"]
        half = near * np.tan(np.radians(self.camera["fov_y"]) / 2)
        x = (2 * (np.arange(self.width) + 0.5) / self.width - 1) * half * self.width / self.height
        y = (1 - 2 * (np.arange(self.height) + 0.5) / self.height) * half
        offset = forward * near + y[:, None, None] * above + x[None, :, None] * right
        offset = offset.reshape(-1, 3)
        return eye + offset, offset / np.linalg.norm(offset, axis=1)[:, None]

    def truth(self) -> tuple[np.ndarray, np.ndarray]:
        """Returns the numbers of the pixels that are compared, and their light in float64."""
        table = np.load(HERE / "truth" / f"{self.name}.npy")
        return table[:, 0].astype(int), table[:, 1:]


def names() -> list[str]:
    return sorted(path.stem for path in (HERE / "scenes").glob("*.toml"))


def distance2(kind: str, shape: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Returns the squared distances of points (.., 3) to a source's core."""
    if kind == "sphere":
        return ((points - shape) ** 2).sum(-1)
    if kind == "segment":
        start, span = shape[:3], shape[3:] - shape[:3]
        at = np.clip((points - start) @ span / (span @ span), 0.0, 1.0)
        return ((points - start - at[..., None] * span) ** 2).sum(-1)
    center, axis, radius = shape[:3], shape[3:6], shape[6]
    height = (points - center) @ axis
    across = np.sqrt(np.maximum(((points - center) ** 2).sum(-1) - height**2, 0.0))
    return (across - radius) ** 2 + height**2
