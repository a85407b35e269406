//! What the tests share.
#![allow(dead_code)] // every folder of tests is a crate of its own and uses its own part
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // tests fail by panicking

pub mod apart;
pub mod engines;
pub mod host;
#[cfg(unix)] // loads a shared library
pub mod layer;
pub mod meshes;
pub mod metaballs;
pub mod occluders;
pub mod program;
pub mod random;
pub mod tile_scenes;

use std::path::PathBuf;

use energywave::image::{DepthAlong, DepthImage, Difference, ImageSize, compare};
use energywave::internals::{Compute, OpenClDevice, discover, with_compiler_options};
use energywave::scene::{
    Antialias, Beam, BeamEnd, Camera, Curve, Cylinder, Decay, Measure, Method, MethodKeys, Profile,
    Sampling, Sphere, Torus,
};
use energywave::{Device, DeviceType, RadianceImage, Renderer, RendererOptions, Scene, reference};
use glam::DVec3;

/// Every lane width that the kernels can be built for; only the device's own on Intel's CPU runtime, which compiles
/// each build for up to a minute, and two in a simulator, where what is several lanes differs by nothing but their
/// number.
pub fn lane_widths() -> Vec<u32> {
    let device = device();
    match device.device_type == DeviceType::Cpu && device.platform.contains("Intel") {
        true => vec![device.lanes],
        false if device.name.contains("Oclgrind") => vec![1, 4],
        false => vec![1, 4, 8, 16],
    }
}

/// The least and the greatest of them, for what does not look at their number: builds are most of the tests' time.
pub fn outer_lane_widths() -> Vec<u32> {
    let widths = lane_widths();
    [widths[0], widths[widths.len() - 1]][..widths.len().min(2)].to_vec()
}

/// Spoils every field by 1 %: no comparison may pass with it.
pub const BROKEN_FIELDS: &str = "-Dtwice_inverse_sqrt(x)=(2.02f/sqrt(x))";

/// For builds that no user gets, spoiled ones and those of another lane width than the device's: compiling them takes
/// half as long, most of the tests' time. What the device draws with is always tested as it is built for users.
const UNOPTIMISED: &str = "-cl-opt-disable";

/// The OpenCL device under test: `ENERGYWAVE_DEVICE`, else a CPU. Fails loudly where there is none.
pub fn device() -> Device {
    let choice = std::env::var("ENERGYWAVE_DEVICE").unwrap_or_else(|_| "cpu".to_owned());
    let device = Device::select(&choice).unwrap_or_else(|error| {
        panic!("these tests need an OpenCL device (Debian, Ubuntu: apt-get install pocl-opencl-icd): {error}")
    });
    assert_ne!(
        device.device_type,
        DeviceType::Reference,
        "these tests check an OpenCL device, not the reference"
    );
    device
}

/// The same device for single kernels.
pub fn compute() -> Compute {
    let name = device().name;
    let found: Vec<OpenClDevice> = discover().devices;
    let device = found.iter().find(|d| d.name == name).unwrap();
    Compute::new(device).unwrap()
}

pub fn options(lanes: u32, extra: &str) -> RendererOptions {
    let mut options = RendererOptions::default();
    options.lanes = Some(lanes);
    options.skips_self_test = true; // spoiled kernels are to be seen
    let is_shipped = extra.is_empty() && lanes == device().lanes;
    match is_shipped {
        true => options,
        false => compiled_with(&options, &format!("{UNOPTIMISED} {extra}")),
    }
}

/// Adds options for the OpenCL compiler, such as those that spoil a kernel.
#[allow(unsafe_code)]
pub fn compiled_with(options: &RendererOptions, extra: &str) -> RendererOptions {
    // SAFETY: what the tests change are numbers; the one that stores all lanes of a vector has memory behind the image.
    unsafe { with_compiler_options(options, extra) }
}

pub fn renderer(lanes: u32, extra: &str) -> Renderer {
    Renderer::with_options(&device(), &options(lanes, extra)).unwrap()
}

/// Divisions of the Simpson rule where nothing else is said.
pub const DIVISIONS: u32 = 200;

/// The length of rays that go 5 times as far beyond the projection plane as the target is.
pub fn far_beyond_target(camera: &Camera) -> f64 {
    5.0 * (camera.eye.distance(camera.target) - camera.near)
}

/// A camera 4 from the origin, as in the paper's figures, light by the parameter, decay alpha = beta = 0.1, no sources.
pub fn empty_scene(width: u32, height: u32) -> Scene {
    let mut scene = Scene::new(Camera::new(DVec3::new(0.3, -3.5, 2.0), DVec3::ZERO));
    scene.camera.ray_length = Some(far_beyond_target(&scene.camera));
    scene.integration.measure = Measure::Parameter;
    scene.integration.antialias = Antialias::None;
    scene.image = ImageSize { width, height };
    scene.integration.method = Method::simpson(DIVISIONS);
    scene.decay = Some(Decay::new(0.1, 0.1));
    scene
}

pub fn sphere(center: [f64; 3], coefficient: f64) -> Sphere {
    Sphere {
        center: center.into(),
        coefficient,
        color: DVec3::new(1.0, 0.5, 0.25),
        profile: Profile::Inverse,
        ..Sphere::default()
    }
}

pub fn cylinder(point: [f64; 3], direction: [f64; 3]) -> Cylinder {
    Cylinder {
        point: point.into(),
        coefficient: 2.0,
        color: DVec3::new(0.3, 0.6, 0.9),
        profile: Profile::Inverse,
        ..Cylinder::new(direction.into())
    }
}

/// With a cap and a sphere of its own, or with a taper.
pub fn beam(tip: [f64; 3], direction: [f64; 3], taper_length: Option<f64>) -> Beam {
    Beam {
        tip: tip.into(),
        coefficient: 1.4,
        end: taper_length.map_or(BeamEnd::Cap(Some(0.9)), BeamEnd::Taper),
        sphere_coefficient: 0.3,
        color: DVec3::new(0.8, 0.3, 0.1),
        profile: Profile::Inverse,
        ..Beam::new(direction.into())
    }
}

pub fn torus(center: [f64; 3], axis: [f64; 3], major_radius: f64) -> Torus {
    Torus {
        center: center.into(),
        axis: axis.into(),
        coefficient: 5.1,
        color: DVec3::new(0.2, 0.4, 1.0),
        profile: Profile::Inverse,
        ..Torus::new(major_radius)
    }
}

pub fn curve(points: [[f64; 3]; 3], intensity: Option<Vec<f64>>) -> Curve {
    Curve {
        coefficient: 5.0,
        color: DVec3::new(0.7, 0.2, 0.5),
        intensity,
        profile: Profile::Inverse,
        ..Curve::new(points.map(DVec3::from))
    }
}

/// Curves of every shape: bent, folded, straight, straight with uneven speed, a point, nearly straight.
pub const CURVE_SHAPES: [[[f64; 3]; 3]; 7] = [
    [[-1.2, -0.2, 0.1], [-0.6, 1.1, -0.3], [0.0, 0.0, 0.1]],
    [[0.0, 0.0, 0.0], [1.5, 0.6, 0.3], [0.5, 0.2, 0.1]],
    [[-1.0, 0.0, 0.5], [0.0, 0.0, 0.5], [1.0, 0.0, 0.5]],
    [[-1.0, 0.0, 0.5], [0.7, 0.0, 0.5], [1.0, 0.0, 0.5]],
    [[0.3, 0.2, 0.1], [0.3, 0.2, 0.1], [0.3, 0.2, 0.1]],
    [[-1.0, 0.0, 0.5], [0.0, 0.0003, 0.5], [1.0, 0.0, 0.5]],
    [[0.4, 0.1, 0.0], [-0.9, 0.8, 1.0], [0.4, 0.1, 0.0]],
];

/// A scene with sources of every kind.
pub fn full_scene(width: u32, height: u32) -> Scene {
    let mut scene = empty_scene(width, height);
    scene.spheres.push(sphere([0.4, 0.3, 0.5], 1.5));
    scene.spheres.push(sphere([-0.7, 0.1, -0.4], 0.5));
    scene
        .cylinders
        .push(cylinder([0.0, 0.6, 0.2], [1.0, 0.2, 0.1]));
    let (right, up) = ([1.0, 0.15, 0.3], [-0.3, 0.2, 0.9]);
    scene.beams.push(beam([-0.3, 0.2, 0.4], right, None));
    scene.beams.push(beam([0.5, 0.4, -0.2], up, Some(0.6)));
    scene
        .tori
        .push(torus([0.1, 0.0, 0.0], [0.1, 0.2, 2.0], 0.9));
    scene
        .tori
        .push(torus([0.0, 0.2, 0.1], [1.0, 0.2, 0.0], 0.4));
    let series = vec![1.0, 0.2, 0.6, 1.0];
    scene.curves.push(curve(CURVE_SHAPES[0], Some(series)));
    for shape in &CURVE_SHAPES[1..] {
        scene.curves.push(curve(*shape, None));
    }
    scene
}

/// The scene with fields that fall off with the squared distance.
pub fn squared(scene: &Scene) -> Scene {
    const SQUARE: Profile = Profile::InverseSquare;
    let mut scene = scene.clone();
    scene.spheres.iter_mut().for_each(|s| s.profile = SQUARE);
    scene.cylinders.iter_mut().for_each(|s| s.profile = SQUARE);
    scene.beams.iter_mut().for_each(|s| s.profile = SQUARE);
    scene.tori.iter_mut().for_each(|s| s.profile = SQUARE);
    scene.curves.iter_mut().for_each(|s| s.profile = SQUARE);
    scene
}

/// A depth image of another size, without interpolation.
pub fn resized(depth: &DepthImage, size: ImageSize) -> DepthImage {
    let from = depth.size();
    let value = |row: u32, column: u32| {
        let row = row * from.height / size.height;
        let column = column * from.width / size.width;
        depth.as_slice()[(row * from.width + column) as usize]
    };
    let rows = (0..size.height).flat_map(|row| (0..size.width).map(move |column| (row, column)));
    let values = rows.map(|(row, column)| value(row, column)).collect();
    DepthImage::new(size, depth.along(), values).unwrap()
}

/// A depth for every pixel of a scene, from its column and row.
pub fn depths(scene: &Scene, along: DepthAlong, value: impl Fn(u32, u32) -> f64) -> DepthImage {
    let size = scene.image;
    let places = (0..size.height).flat_map(|row| (0..size.width).map(move |column| (column, row)));
    let values = places
        .map(|(column, row)| value(column, row) as f32)
        .collect();
    DepthImage::new(size, along, values).unwrap()
}

pub fn difference(image: &RadianceImage, reference: &RadianceImage) -> Difference {
    compare(image, reference).expect("images of one size")
}

/// What no float32 device can undercut: for 99.9 % of the pixels, and for the worst.
const MOST_PIXELS: f64 = 2e-5;
pub const WORST_PIXEL: f64 = 2e-4;

/// Whether an image meets a tolerance: 99.9 % of its pixels do, and none is off by more than ten times as much.
pub fn meets(found: &Difference, tolerance: f64) -> bool {
    found.p999 <= tolerance.max(MOST_PIXELS) && found.max <= (10.0 * tolerance).max(WORST_PIXEL)
}

/// The image by the float64 Simpson rule, with as many divisions as the scene has.
pub fn simpson_reference(scene: &Scene) -> RadianceImage {
    let Method::Simpson { divisions } = scene.integration.method else {
        panic!("no scene for Simpson's rule: {:?}", scene.integration);
    };
    reference::render_simpson(scene, divisions).unwrap()
}

/// The tolerance of a scene whose method has one.
pub fn tolerance(scene: &Scene) -> f64 {
    match scene.integration.method {
        Method::Exact { tolerance, .. } => tolerance,
        other => panic!("no tolerance: {other:?}"),
    }
}

/// The scene by the method `exact`, which it has, to another tolerance.
pub fn at_tolerance(scene: &Scene, wanted: f64) -> Scene {
    let mut scene = scene.clone();
    match &mut scene.integration.method {
        Method::Exact { tolerance, .. } => *tolerance = wanted,
        other => panic!("no tolerance: {other:?}"),
    }
    scene
}

/// The scene by the method `exact`, which it has, sampled in another way.
pub fn sampled(scene: &Scene, wanted: Sampling) -> Scene {
    let mut scene = scene.clone();
    match &mut scene.integration.method {
        Method::Exact { sampling, .. } => *sampling = wanted,
        other => panic!("no sampling: {other:?}"),
    }
    scene
}

/// The method `exact` to its default tolerance.
pub fn by(sampling: Sampling) -> Method {
    Method::Exact {
        tolerance: 1e-3,
        sampling,
    }
}

/// Simpson's rule as a scene file describes it.
pub fn simpson_of(keys: &MethodKeys) -> Method {
    Method::simpson(keys.divisions)
}

/// The method `exact` as a scene file describes it.
pub fn exact_of(keys: &MethodKeys) -> Method {
    Method::Exact {
        tolerance: keys.tolerance,
        sampling: keys.sampling,
    }
}

/// The paths of the repository's scenes.
pub fn scene_files() -> Vec<PathBuf> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes");
    let entries = std::fs::read_dir(folder).unwrap();
    let paths = entries.map(|entry| entry.unwrap().path());
    let scenes: Vec<PathBuf> = paths
        .filter(|path| path.extension().is_some_and(|ending| ending == "toml"))
        .collect();
    assert!(scenes.len() >= 27, "only {} scenes", scenes.len());
    scenes
}

/// The scenes of the repository, so many pixels wide and high, by a method.
pub fn figures(size: u32, method: fn(&MethodKeys) -> Method) -> Vec<(String, Scene)> {
    let figure = |path: PathBuf| {
        let by_method = |scene: &mut Scene, keys: &MethodKeys| {
            scene.integration.method = method(keys);
            scene.integration.antialias = Antialias::None;
            Ok(())
        };
        let mut scene = Scene::from_file_with(&path, by_method).unwrap();
        (scene.image.width, scene.image.height) = (size, size);
        scene.depth = scene.depth.map(|depth| resized(&depth, scene.image));
        scene.lighting = None; // whose shadows have an error of their own
        let name = path.file_stem().unwrap().to_str().unwrap().to_owned();
        (name, scene)
    };
    let has_light = |(_, scene): &(String, Scene)| scene.source_count() > 0;
    scene_files()
        .into_iter()
        .map(figure)
        .filter(has_light)
        .collect()
}
