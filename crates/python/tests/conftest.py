"""Small scenes that the tests draw. They look for one set of kernels, so that little is compiled."""

import energywave as ew
import pytest


def ring(**changes):
    """A ring and a point of light, 64x48."""
    torus = dict(dict(major_radius=0.9, coefficient=0.01, color=[0.15, 0.35, 1.0]), **changes)
    scene = ew.Scene(ew.Camera(eye=[0, -4, 2], target=[0, 0, 0]), ew.Image(width=64, height=48))
    scene.add(ew.Torus(**torus))
    return scene


@pytest.fixture
def scene():
    return ring()


@pytest.fixture(scope="session")
def renderer():
    return ew.Renderer()
