"""The tables of a scene. Written by stubs.py from the schema of scene files; change nothing here."""

from collections.abc import Mapping, Sequence
from os import PathLike
from typing import Any, Dict, Literal, Optional, Tuple, TypeVar, Union

from numpy.typing import ArrayLike

Self = TypeVar("Self", bound="Table")
_Tables = Mapping[str, Any]
_Number = Union[float, "Track", _Tables]
_Values = Union[ArrayLike, "Track", _Tables, Sequence[Any]]

SCHEMA: Dict[str, Any]
TABLES: Dict[str, type]

def plain(value: Any, place: str) -> Any: ...
def class_name(table: str) -> str: ...
def keys_of(schema: Dict[str, Any]) -> Dict[str, Dict[str, Any]]: ...

class Table:
    _name: str
    _keys: Dict[str, Dict[str, Any]]
    _required: Tuple[str, ...]
    def __init__(self, **values: Any) -> None: ...
    def replace(self: Self, **values: Any) -> Self: ...
    def to_dict(self) -> Dict[str, Any]: ...

class Absorption(Table):
    kappa: _Number
    def __init__(
        self,
        *,
        kappa: _Number,
    ) -> None: ...

class Acceleration(Table):
    continuous: _Number
    continuous_range: _Number
    separate: _Number
    separate_range: _Number
    def __init__(
        self,
        *,
        continuous: Optional[_Number] = None,
        continuous_range: Optional[_Number] = None,
        separate: Optional[_Number] = None,
        separate_range: Optional[_Number] = None,
    ) -> None: ...

class Arc(Table):
    amplitude: _Number
    branches: int
    drift: _Number
    scale: _Number
    seed: int
    time: _Number
    def __init__(
        self,
        *,
        amplitude: _Number,
        scale: _Number,
        branches: Optional[int] = None,
        drift: Optional[_Number] = None,
        seed: Optional[int] = None,
        time: Optional[_Number] = None,
    ) -> None: ...

class Beam(Table):
    arc: Union[Arc, _Tables]
    cap_coefficient: _Number
    coefficient: _Number
    color: Union[_Values, str]
    colors: Union[_Values, str]
    dashes: Union[Dashes, _Tables]
    direction: _Values
    intensity: _Values
    layers: Sequence[Union[Layers, _Tables]]
    light_group: str
    peak: _Number
    profile: Literal["inverse", "inverse-square", "inverse-cube", "gaussian", "smeared", "convolution"]
    radii: _Values
    radius: _Number
    reach: _Number
    series_length: _Number
    sphere_coefficient: _Number
    taper_length: _Number
    tip: _Values
    def __init__(
        self,
        *,
        direction: _Values,
        arc: Optional[Union[Arc, _Tables]] = None,
        cap_coefficient: Optional[_Number] = None,
        coefficient: Optional[_Number] = None,
        color: Optional[Union[_Values, str]] = None,
        colors: Optional[Union[_Values, str]] = None,
        dashes: Optional[Union[Dashes, _Tables]] = None,
        intensity: Optional[_Values] = None,
        layers: Optional[Sequence[Union[Layers, _Tables]]] = None,
        light_group: Optional[str] = None,
        peak: Optional[_Number] = None,
        profile: Optional[Literal["inverse", "inverse-square", "inverse-cube", "gaussian", "smeared", "convolution"]] = None,
        radii: Optional[_Values] = None,
        radius: Optional[_Number] = None,
        reach: Optional[_Number] = None,
        series_length: Optional[_Number] = None,
        sphere_coefficient: Optional[_Number] = None,
        taper_length: Optional[_Number] = None,
        tip: Optional[_Values] = None,
    ) -> None: ...

class Bloom(Table):
    radius: _Number
    strength: _Number
    def __init__(
        self,
        *,
        strength: _Number,
        radius: Optional[_Number] = None,
    ) -> None: ...

class Camera(Table):
    eye: _Values
    fov_y: _Number
    jitter: _Values
    near: _Number
    projection: _Values
    range: Literal["0..1", "-1..1"]
    ray_length: _Number
    target: _Values
    up: _Values
    view: _Values
    y: Literal["up", "down"]
    def __init__(
        self,
        *,
        eye: Optional[_Values] = None,
        fov_y: Optional[_Number] = None,
        jitter: Optional[_Values] = None,
        near: Optional[_Number] = None,
        projection: Optional[_Values] = None,
        range: Optional[Literal["0..1", "-1..1"]] = None,
        ray_length: Optional[_Number] = None,
        target: Optional[_Values] = None,
        up: Optional[_Values] = None,
        view: Optional[_Values] = None,
        y: Optional[Literal["up", "down"]] = None,
    ) -> None: ...

class Collider(Table):
    box: Union[ColliderBox, _Tables]
    color: Union[_Values, str]
    mesh: Union[Mesh, _Tables]
    plane: Union[ColliderPlane, _Tables]
    sphere: Union[ColliderSphere, _Tables]
    visible: bool
    def __init__(
        self,
        *,
        box: Optional[Union[ColliderBox, _Tables]] = None,
        color: Optional[Union[_Values, str]] = None,
        mesh: Optional[Union[Mesh, _Tables]] = None,
        plane: Optional[Union[ColliderPlane, _Tables]] = None,
        sphere: Optional[Union[ColliderSphere, _Tables]] = None,
        visible: Optional[bool] = None,
    ) -> None: ...

class ColliderBox(Table):
    center: _Values
    half: _Values
    rotation: Union[Rotate, _Tables]
    def __init__(
        self,
        *,
        half: _Values,
        center: Optional[_Values] = None,
        rotation: Optional[Union[Rotate, _Tables]] = None,
    ) -> None: ...

class ColliderPlane(Table):
    normal: _Values
    point: _Values
    def __init__(
        self,
        *,
        normal: Optional[_Values] = None,
        point: Optional[_Values] = None,
    ) -> None: ...

class ColliderSphere(Table):
    center: _Values
    radius: _Number
    def __init__(
        self,
        *,
        radius: _Number,
        center: Optional[_Values] = None,
    ) -> None: ...

class Control(Table):
    position: _Values
    probability: _Number
    range: _Values
    def __init__(
        self,
        *,
        position: _Values,
        probability: Optional[_Number] = None,
        range: Optional[_Values] = None,
    ) -> None: ...

class Curve(Table):
    coefficient: _Number
    color: Union[_Values, str]
    colors: Union[_Values, str]
    control_points: _Values
    dashes: Union[Dashes, _Tables]
    intensity: _Values
    layers: Sequence[Union[Layers, _Tables]]
    light_group: str
    peak: _Number
    profile: Literal["inverse", "inverse-square", "inverse-cube", "gaussian", "smeared", "convolution"]
    radii: _Values
    radius: _Number
    reach: _Number
    def __init__(
        self,
        *,
        control_points: _Values,
        coefficient: Optional[_Number] = None,
        color: Optional[Union[_Values, str]] = None,
        colors: Optional[Union[_Values, str]] = None,
        dashes: Optional[Union[Dashes, _Tables]] = None,
        intensity: Optional[_Values] = None,
        layers: Optional[Sequence[Union[Layers, _Tables]]] = None,
        light_group: Optional[str] = None,
        peak: Optional[_Number] = None,
        profile: Optional[Literal["inverse", "inverse-square", "inverse-cube", "gaussian", "smeared", "convolution"]] = None,
        radii: Optional[_Values] = None,
        radius: Optional[_Number] = None,
        reach: Optional[_Number] = None,
    ) -> None: ...

class Cylinder(Table):
    coefficient: _Number
    color: Union[_Values, str]
    direction: _Values
    layers: Sequence[Union[Layers, _Tables]]
    light_group: str
    peak: _Number
    point: _Values
    profile: Literal["inverse", "inverse-square", "inverse-cube", "gaussian", "smeared", "convolution"]
    radius: _Number
    reach: _Number
    def __init__(
        self,
        *,
        direction: _Values,
        coefficient: Optional[_Number] = None,
        color: Optional[Union[_Values, str]] = None,
        layers: Optional[Sequence[Union[Layers, _Tables]]] = None,
        light_group: Optional[str] = None,
        peak: Optional[_Number] = None,
        point: Optional[_Values] = None,
        profile: Optional[Literal["inverse", "inverse-square", "inverse-cube", "gaussian", "smeared", "convolution"]] = None,
        radius: Optional[_Number] = None,
        reach: Optional[_Number] = None,
    ) -> None: ...

class Dashes(Table):
    count: int
    fill: _Number
    offset: _Number
    def __init__(
        self,
        *,
        count: int,
        fill: Optional[_Number] = None,
        offset: Optional[_Number] = None,
    ) -> None: ...

class Decay(Table):
    alpha: _Number
    beta: _Number
    power: int
    def __init__(
        self,
        *,
        alpha: _Number,
        beta: _Number,
        power: Optional[int] = None,
    ) -> None: ...

class Depth(Table):
    along: Literal["ray", "axis", "ndc", "buffer"]
    channel: str
    file: Union[str, "PathLike[str]"]
    none: Union[_Number, str]
    projection: _Values
    range: Literal["0..1", "-1..1"]
    scale: _Number
    def __init__(
        self,
        *,
        file: Union[str, "PathLike[str]"],
        along: Optional[Literal["ray", "axis", "ndc", "buffer"]] = None,
        channel: Optional[str] = None,
        none: Optional[Union[_Number, str]] = None,
        projection: Optional[_Values] = None,
        range: Optional[Literal["0..1", "-1..1"]] = None,
        scale: Optional[_Number] = None,
    ) -> None: ...

class Display(Table):
    alpha: Literal["opaque", "additive", "luminance"]
    background: Union[_Values, str]
    bits: int
    bloom: Union[Bloom, _Tables]
    exposure: Union[_Number, str]
    quality: int
    tone_map: Literal["agx", "khronos-neutral", "clamp", "exponential", "reinhard", "aces"]
    def __init__(
        self,
        *,
        alpha: Optional[Literal["opaque", "additive", "luminance"]] = None,
        background: Optional[Union[_Values, str]] = None,
        bits: Optional[int] = None,
        bloom: Optional[Union[Bloom, _Tables]] = None,
        exposure: Optional[Union[_Number, str]] = None,
        quality: Optional[int] = None,
        tone_map: Optional[Literal["agx", "khronos-neutral", "clamp", "exponential", "reinhard", "aces"]] = None,
    ) -> None: ...

class Group(Table):
    beam: Sequence[Union[Beam, _Tables]]
    curve: Sequence[Union[Curve, _Tables]]
    cylinder: Sequence[Union[Cylinder, _Tables]]
    group: Sequence[Union[Group, _Tables]]
    light_group: str
    path: Sequence[Union[Path, _Tables]]
    repeat: Union[Repeat, _Tables]
    rotate: Union[Rotate, _Tables]
    scale: _Number
    segment: Sequence[Union[Segment, _Tables]]
    sphere: Sequence[Union[Sphere, _Tables]]
    torus: Sequence[Union[Torus, _Tables]]
    translate: _Values
    def __init__(
        self,
        *,
        beam: Optional[Sequence[Union[Beam, _Tables]]] = None,
        curve: Optional[Sequence[Union[Curve, _Tables]]] = None,
        cylinder: Optional[Sequence[Union[Cylinder, _Tables]]] = None,
        group: Optional[Sequence[Union[Group, _Tables]]] = None,
        light_group: Optional[str] = None,
        path: Optional[Sequence[Union[Path, _Tables]]] = None,
        repeat: Optional[Union[Repeat, _Tables]] = None,
        rotate: Optional[Union[Rotate, _Tables]] = None,
        scale: Optional[_Number] = None,
        segment: Optional[Sequence[Union[Segment, _Tables]]] = None,
        sphere: Optional[Sequence[Union[Sphere, _Tables]]] = None,
        torus: Optional[Sequence[Union[Torus, _Tables]]] = None,
        translate: Optional[_Values] = None,
    ) -> None: ...

class Image(Table):
    height: int
    width: int
    def __init__(
        self,
        *,
        height: Optional[int] = None,
        width: Optional[int] = None,
    ) -> None: ...

class Integration(Table):
    absolute_tolerance: _Number
    antialias: Literal["footprint", "none"]
    crowd: Literal["auto", "never"]
    divisions: int
    hidden_surfaces: bool
    measure: Literal["parameter", "length"]
    method: Literal["simpson", "jittered", "exact"]
    reduction: Literal["sum", "rms"]
    sampling: Literal["pixels", "tiles"]
    seed: int
    slices: int
    softening: _Number
    tolerance: _Number
    volume_method: Literal["ray", "slices"]
    volume_step: _Number
    def __init__(
        self,
        *,
        absolute_tolerance: Optional[_Number] = None,
        antialias: Optional[Literal["footprint", "none"]] = None,
        crowd: Optional[Literal["auto", "never"]] = None,
        divisions: Optional[int] = None,
        hidden_surfaces: Optional[bool] = None,
        measure: Optional[Literal["parameter", "length"]] = None,
        method: Optional[Literal["simpson", "jittered", "exact"]] = None,
        reduction: Optional[Literal["sum", "rms"]] = None,
        sampling: Optional[Literal["pixels", "tiles"]] = None,
        seed: Optional[int] = None,
        slices: Optional[int] = None,
        softening: Optional[_Number] = None,
        tolerance: Optional[_Number] = None,
        volume_method: Optional[Literal["ray", "slices"]] = None,
        volume_step: Optional[_Number] = None,
    ) -> None: ...

class Lattice(Table):
    columns: _Values
    count: int
    jitter: _Number
    seed: int
    spacing: _Number
    def __init__(
        self,
        *,
        count: int,
        spacing: _Number,
        columns: Optional[_Values] = None,
        jitter: Optional[_Number] = None,
        seed: Optional[int] = None,
    ) -> None: ...

class Layers(Table):
    coefficient: _Number
    color: Union[_Values, str]
    peak: _Number
    profile: Literal["inverse", "inverse-square", "inverse-cube", "gaussian", "smeared", "convolution"]
    radius: _Number
    reach: _Number
    def __init__(
        self,
        *,
        coefficient: Optional[_Number] = None,
        color: Optional[Union[_Values, str]] = None,
        peak: Optional[_Number] = None,
        profile: Optional[Literal["inverse", "inverse-square", "inverse-cube", "gaussian", "smeared", "convolution"]] = None,
        radius: Optional[_Number] = None,
        reach: Optional[_Number] = None,
    ) -> None: ...

class LightBall(Table):
    alphas: _Values
    cells: int
    colors: Union[_Values, str]
    radii: _Values
    def __init__(
        self,
        *,
        alphas: Optional[_Values] = None,
        cells: Optional[int] = None,
        colors: Optional[Union[_Values, str]] = None,
        radii: Optional[_Values] = None,
    ) -> None: ...

class Lighting(Table):
    ambient: Union[_Values, str]
    cast: bool
    gain: _Number
    radius: _Number
    shadow_samples: int
    shadows: bool
    sun: Union[Sun, _Tables]
    def __init__(
        self,
        *,
        ambient: Optional[Union[_Values, str]] = None,
        cast: Optional[bool] = None,
        gain: Optional[_Number] = None,
        radius: Optional[_Number] = None,
        shadow_samples: Optional[int] = None,
        shadows: Optional[bool] = None,
        sun: Optional[Union[Sun, _Tables]] = None,
    ) -> None: ...

class Mesh(Table):
    albedo: Union[_Values, str]
    file: Union[str, "PathLike[str]"]
    rotate: Union[Rotate, _Tables]
    scale: _Number
    translate: _Values
    triangles: _Values
    vertices: _Values
    def __init__(
        self,
        *,
        albedo: Optional[Union[_Values, str]] = None,
        file: Optional[Union[str, "PathLike[str]"]] = None,
        rotate: Optional[Union[Rotate, _Tables]] = None,
        scale: Optional[_Number] = None,
        translate: Optional[_Values] = None,
        triangles: Optional[_Values] = None,
        vertices: Optional[_Values] = None,
    ) -> None: ...

class Metaballs(Table):
    color: Union[_Values, str]
    file: Union[str, "PathLike[str]"]
    interval: _Number
    kernel: Literal["cone", "smooth"]
    lattice: Union[Lattice, _Tables]
    method: Literal["exact", "sampling"]
    points: _Values
    radius: _Number
    refinements: int
    samples: int
    shading: Literal["lit", "normals"]
    threshold: _Number
    translate: _Values
    def __init__(
        self,
        *,
        color: Optional[Union[_Values, str]] = None,
        file: Optional[Union[str, "PathLike[str]"]] = None,
        interval: Optional[_Number] = None,
        kernel: Optional[Literal["cone", "smooth"]] = None,
        lattice: Optional[Union[Lattice, _Tables]] = None,
        method: Optional[Literal["exact", "sampling"]] = None,
        points: Optional[_Values] = None,
        radius: Optional[_Number] = None,
        refinements: Optional[int] = None,
        samples: Optional[int] = None,
        shading: Optional[Literal["lit", "normals"]] = None,
        threshold: Optional[_Number] = None,
        translate: Optional[_Values] = None,
    ) -> None: ...

class Mixture(Table):
    probability: _Number
    roundness: _Number
    samples: int
    def __init__(
        self,
        *,
        probability: _Number,
        roundness: Optional[_Number] = None,
        samples: Optional[int] = None,
    ) -> None: ...

class Noise(Table):
    amplitude: _Number
    frequency: float
    octaves: int
    seed: int
    def __init__(
        self,
        *,
        amplitude: _Number,
        frequency: float,
        octaves: Optional[int] = None,
        seed: Optional[int] = None,
    ) -> None: ...

class Particles(Table):
    coefficient: _Number
    color: Union[_Values, str]
    file: Union[str, "PathLike[str]"]
    kernel: Literal["cone", "smooth"]
    lattice: Union[Lattice, _Tables]
    points: _Values
    radius: _Number
    translate: _Values
    def __init__(
        self,
        *,
        coefficient: Optional[_Number] = None,
        color: Optional[Union[_Values, str]] = None,
        file: Optional[Union[str, "PathLike[str]"]] = None,
        kernel: Optional[Literal["cone", "smooth"]] = None,
        lattice: Optional[Union[Lattice, _Tables]] = None,
        points: Optional[_Values] = None,
        radius: Optional[_Number] = None,
        translate: Optional[_Values] = None,
    ) -> None: ...

class Path(Table):
    arc: Union[Arc, _Tables]
    closed: bool
    coefficient: _Number
    color: Union[_Values, str]
    colors: Union[_Values, str]
    dashes: Union[Dashes, _Tables]
    flatness: _Number
    intensity: _Values
    layers: Sequence[Union[Layers, _Tables]]
    light_group: str
    peak: _Number
    points: _Values
    profile: Literal["inverse", "inverse-square", "inverse-cube", "gaussian", "smeared", "convolution"]
    radii: _Values
    radius: _Number
    reach: _Number
    shape: Literal["polyline", "spline", "quadratic", "cubic"]
    def __init__(
        self,
        *,
        points: _Values,
        arc: Optional[Union[Arc, _Tables]] = None,
        closed: Optional[bool] = None,
        coefficient: Optional[_Number] = None,
        color: Optional[Union[_Values, str]] = None,
        colors: Optional[Union[_Values, str]] = None,
        dashes: Optional[Union[Dashes, _Tables]] = None,
        flatness: Optional[_Number] = None,
        intensity: Optional[_Values] = None,
        layers: Optional[Sequence[Union[Layers, _Tables]]] = None,
        light_group: Optional[str] = None,
        peak: Optional[_Number] = None,
        profile: Optional[Literal["inverse", "inverse-square", "inverse-cube", "gaussian", "smeared", "convolution"]] = None,
        radii: Optional[_Values] = None,
        radius: Optional[_Number] = None,
        reach: Optional[_Number] = None,
        shape: Optional[Literal["polyline", "spline", "quadratic", "cubic"]] = None,
    ) -> None: ...

class Points(Table):
    coefficient: _Number
    coefficients: _Values
    color: Union[_Values, str]
    colors: Union[_Values, str]
    file: Union[str, "PathLike[str]"]
    positions: _Values
    previous: _Values
    profile: Literal["inverse", "inverse-square", "inverse-cube", "gaussian", "smeared", "convolution"]
    radius: _Number
    reach: _Number
    def __init__(
        self,
        *,
        coefficient: Optional[_Number] = None,
        coefficients: Optional[_Values] = None,
        color: Optional[Union[_Values, str]] = None,
        colors: Optional[Union[_Values, str]] = None,
        file: Optional[Union[str, "PathLike[str]"]] = None,
        positions: Optional[_Values] = None,
        previous: Optional[_Values] = None,
        profile: Optional[Literal["inverse", "inverse-square", "inverse-cube", "gaussian", "smeared", "convolution"]] = None,
        radius: Optional[_Number] = None,
        reach: Optional[_Number] = None,
    ) -> None: ...

class Repeat(Table):
    angle: _Number
    axis: _Values
    count: int
    step: _Values
    def __init__(
        self,
        *,
        count: int,
        angle: Optional[_Number] = None,
        axis: Optional[_Values] = None,
        step: Optional[_Values] = None,
    ) -> None: ...

class Rotate(Table):
    angle: _Number
    axis: _Values
    def __init__(
        self,
        *,
        angle: _Number,
        axis: _Values,
    ) -> None: ...

class Segment(Table):
    arc: Union[Arc, _Tables]
    coefficient: _Number
    color: Union[_Values, str]
    colors: Union[_Values, str]
    dashes: Union[Dashes, _Tables]
    from_: _Values
    intensity: _Values
    layers: Sequence[Union[Layers, _Tables]]
    light_group: str
    peak: _Number
    profile: Literal["inverse", "inverse-square", "inverse-cube", "gaussian", "smeared", "convolution"]
    radii: _Values
    radius: _Number
    reach: _Number
    taper_lengths: _Values
    to: _Values
    def __init__(
        self,
        *,
        from_: _Values,
        to: _Values,
        arc: Optional[Union[Arc, _Tables]] = None,
        coefficient: Optional[_Number] = None,
        color: Optional[Union[_Values, str]] = None,
        colors: Optional[Union[_Values, str]] = None,
        dashes: Optional[Union[Dashes, _Tables]] = None,
        intensity: Optional[_Values] = None,
        layers: Optional[Sequence[Union[Layers, _Tables]]] = None,
        light_group: Optional[str] = None,
        peak: Optional[_Number] = None,
        profile: Optional[Literal["inverse", "inverse-square", "inverse-cube", "gaussian", "smeared", "convolution"]] = None,
        radii: Optional[_Values] = None,
        radius: Optional[_Number] = None,
        reach: Optional[_Number] = None,
        taper_lengths: Optional[_Values] = None,
    ) -> None: ...

class Simulation(Table):
    frame: _Number
    seed: int
    time: _Number
    def __init__(
        self,
        *,
        frame: Optional[_Number] = None,
        seed: Optional[int] = None,
        time: Optional[_Number] = None,
    ) -> None: ...

class Sphere(Table):
    center: _Values
    coefficient: _Number
    color: Union[_Values, str]
    layers: Sequence[Union[Layers, _Tables]]
    light_group: str
    peak: _Number
    profile: Literal["inverse", "inverse-square", "inverse-cube", "gaussian", "smeared", "convolution"]
    radius: _Number
    reach: _Number
    def __init__(
        self,
        *,
        center: Optional[_Values] = None,
        coefficient: Optional[_Number] = None,
        color: Optional[Union[_Values, str]] = None,
        layers: Optional[Sequence[Union[Layers, _Tables]]] = None,
        light_group: Optional[str] = None,
        peak: Optional[_Number] = None,
        profile: Optional[Literal["inverse", "inverse-square", "inverse-cube", "gaussian", "smeared", "convolution"]] = None,
        radius: Optional[_Number] = None,
        reach: Optional[_Number] = None,
    ) -> None: ...

class Sun(Table):
    color: Union[_Values, str]
    direction: _Values
    def __init__(
        self,
        *,
        direction: _Values,
        color: Optional[Union[_Values, str]] = None,
    ) -> None: ...

class Time(Table):
    loop: float
    shutter: float
    def __init__(
        self,
        *,
        loop: Optional[float] = None,
        shutter: Optional[float] = None,
    ) -> None: ...

class Torus(Table):
    arc: Union[Arc, _Tables]
    axis: _Values
    center: _Values
    coefficient: _Number
    color: Union[_Values, str]
    colors: Union[_Values, str]
    dashes: Union[Dashes, _Tables]
    intensity: _Values
    layers: Sequence[Union[Layers, _Tables]]
    light_group: str
    major_radius: _Number
    peak: _Number
    profile: Literal["inverse", "inverse-square", "inverse-cube", "gaussian", "smeared", "convolution"]
    radii: _Values
    radius: _Number
    reach: _Number
    start: _Values
    sweep: _Values
    def __init__(
        self,
        *,
        major_radius: _Number,
        arc: Optional[Union[Arc, _Tables]] = None,
        axis: Optional[_Values] = None,
        center: Optional[_Values] = None,
        coefficient: Optional[_Number] = None,
        color: Optional[Union[_Values, str]] = None,
        colors: Optional[Union[_Values, str]] = None,
        dashes: Optional[Union[Dashes, _Tables]] = None,
        intensity: Optional[_Values] = None,
        layers: Optional[Sequence[Union[Layers, _Tables]]] = None,
        light_group: Optional[str] = None,
        peak: Optional[_Number] = None,
        profile: Optional[Literal["inverse", "inverse-square", "inverse-cube", "gaussian", "smeared", "convolution"]] = None,
        radii: Optional[_Values] = None,
        radius: Optional[_Number] = None,
        reach: Optional[_Number] = None,
        start: Optional[_Values] = None,
        sweep: Optional[_Values] = None,
    ) -> None: ...

class Track(Table):
    interpolation: Literal["step", "linear", "cubic", "smooth"]
    loop: Literal["once", "repeat", "ping-pong"]
    noise: Union[Noise, _Tables]
    phase: float
    times: _Values
    value: _Number
    values: _Values
    def __init__(
        self,
        *,
        interpolation: Optional[Literal["step", "linear", "cubic", "smooth"]] = None,
        loop: Optional[Literal["once", "repeat", "ping-pong"]] = None,
        noise: Optional[Union[Noise, _Tables]] = None,
        phase: Optional[float] = None,
        times: Optional[_Values] = None,
        value: Optional[_Number] = None,
        values: Optional[_Values] = None,
    ) -> None: ...

class Volume(Table):
    center: _Values
    coefficient: _Number
    color: Union[_Values, str]
    file: Union[str, "PathLike[str]"]
    interpolation: Literal["linear", "cubic"]
    light_ball: Union[LightBall, _Tables]
    method: Literal["volume", "billboard"]
    rotation: _Values
    size: _Values
    slices: str
    def __init__(
        self,
        *,
        center: Optional[_Values] = None,
        coefficient: Optional[_Number] = None,
        color: Optional[Union[_Values, str]] = None,
        file: Optional[Union[str, "PathLike[str]"]] = None,
        interpolation: Optional[Literal["linear", "cubic"]] = None,
        light_ball: Optional[Union[LightBall, _Tables]] = None,
        method: Optional[Literal["volume", "billboard"]] = None,
        rotation: Optional[_Values] = None,
        size: Optional[_Values] = None,
        slices: Optional[str] = None,
    ) -> None: ...

class Wave(Table):
    acceleration: Union[Acceleration, _Tables]
    circular: _Number
    coefficient: _Number
    color: Union[_Values, str]
    continuous: _Number
    control: Sequence[Union[Control, _Tables]]
    damper: _Number
    direction: _Values
    draw: Literal["streaks", "sprites"]
    flight: _Number
    lifetime: _Number
    lifetime_range: _Number
    mixture: Sequence[Union[Mixture, _Tables]]
    origin: _Values
    radius: _Number
    rate: _Number
    reach: _Number
    repulsion: _Number
    response: Literal["replace", "accelerate"]
    roundness: _Number
    samples: int
    signs: Literal["corrected", "printed"]
    size: _Number
    spacing: _Number
    speed: _Number
    spring: _Number
    threads: int
    def __init__(
        self,
        *,
        direction: _Values,
        acceleration: Optional[Union[Acceleration, _Tables]] = None,
        circular: Optional[_Number] = None,
        coefficient: Optional[_Number] = None,
        color: Optional[Union[_Values, str]] = None,
        continuous: Optional[_Number] = None,
        control: Optional[Sequence[Union[Control, _Tables]]] = None,
        damper: Optional[_Number] = None,
        draw: Optional[Literal["streaks", "sprites"]] = None,
        flight: Optional[_Number] = None,
        lifetime: Optional[_Number] = None,
        lifetime_range: Optional[_Number] = None,
        mixture: Optional[Sequence[Union[Mixture, _Tables]]] = None,
        origin: Optional[_Values] = None,
        radius: Optional[_Number] = None,
        rate: Optional[_Number] = None,
        reach: Optional[_Number] = None,
        repulsion: Optional[_Number] = None,
        response: Optional[Literal["replace", "accelerate"]] = None,
        roundness: Optional[_Number] = None,
        samples: Optional[int] = None,
        signs: Optional[Literal["corrected", "printed"]] = None,
        size: Optional[_Number] = None,
        spacing: Optional[_Number] = None,
        speed: Optional[_Number] = None,
        spring: Optional[_Number] = None,
        threads: Optional[int] = None,
    ) -> None: ...

__all__ = ["Absorption", "Acceleration", "Arc", "Beam", "Bloom", "Camera", "Collider", "ColliderBox", "ColliderPlane", "ColliderSphere", "Control", "Curve", "Cylinder", "Dashes", "Decay", "Depth", "Display", "Group", "Image", "Integration", "Lattice", "Layers", "LightBall", "Lighting", "Mesh", "Metaballs", "Mixture", "Noise", "Particles", "Path", "Points", "Repeat", "Rotate", "Segment", "Simulation", "Sphere", "Sun", "Time", "Torus", "Track", "Volume", "Wave"]
