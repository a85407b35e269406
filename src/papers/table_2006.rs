//! The renderers of Sakai 2006, timed: the beam of its figure 5.4 by ray casting, and as a volume by slices, by
//! integrals along rays, and as a billboard. The thesis has no table, and gives no size of a volume or of a picture.

use std::ops::ControlFlow;
use std::time::Duration;

use glam::DVec3;

use super::{Speed, measure};
use crate::error::Result;
use crate::image::ImageSize;
use crate::render::Renderer;
use crate::scene::{
    Antialias, Camera, Measure, Method, Scene, Segment, Sphere, Volume, VolumeMethod, VolumeShape,
};
use crate::volume::{CellValue, Grid, Storage, Texture};

/// The box of the beam, world units.
const EDGES: DVec3 = DVec3::new(1.4, 1.4, 3.4);

/// A way of 2006 to draw a wave.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method2006 {
    /// The beam's field by Simpson's rule of 200 divisions, without cells.
    RayCasting,
    /// Its cells, by 256 slices perpendicular to the view.
    Slices,
    /// Its cells, in pieces of a cell along rays: not of 2006.
    Rays,
    /// One picture of its cells that faces the view.
    Billboard,
}

impl Method2006 {
    /// Returns its name.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::RayCasting => "ray-casting",
            Self::Slices => "slices",
            Self::Rays => "rays",
            Self::Billboard => "billboard",
        }
    }
}

/// A cell of the table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Cell2006 {
    /// Cells along the beam; 0 of ray casting.
    pub cells: u32,
    /// Width and height, pixels.
    pub resolution: u32,
    /// How it is drawn.
    pub method: Method2006,
}

/// Returns the table: two sizes of the picture, and of each three numbers of cells.
#[must_use]
pub fn table_2006() -> Vec<Cell2006> {
    let volumes = [Method2006::Slices, Method2006::Rays, Method2006::Billboard];
    let of_size = |resolution: u32| {
        let cell = move |cells, method| Cell2006 {
            cells,
            resolution,
            method,
        };
        let of_cells = move |cells| volumes.map(|method| cell(cells, method));
        let casting = [cell(0, Method2006::RayCasting)];
        casting
            .into_iter()
            .chain([64, 128, 256].into_iter().flat_map(of_cells))
    };
    [256, 512].into_iter().flat_map(of_size).collect()
}

/// Returns the beam as its field, seen from before it.
fn beam(resolution: u32) -> Scene {
    let mut scene = Scene::new(Camera::new(DVec3::new(0.0, -8.0, 0.0), DVec3::ZERO));
    scene.camera.fov_y = 30.0;
    scene.image = ImageSize {
        width: resolution,
        height: resolution,
    };
    scene.integration.measure = Measure::Length;
    scene.integration.antialias = Antialias::None;
    scene.integration.method = Method::simpson(200);
    let (low, high) = (-1.1 * DVec3::Z, 1.1 * DVec3::Z);
    scene.segments.push(Segment {
        coefficient: 0.25,
        radius: 0.06,
        reach: Some(0.58),
        ..Segment::new(low, high)
    });
    scene.spheres.push(Sphere {
        center: low,
        coefficient: 0.25,
        radius: 0.1,
        reach: Some(0.58),
        ..Sphere::default()
    });
    scene
}

/// Fills so many cells along the beam of 2006 with its light.
///
/// # Errors
/// As [`Renderer::bake`].
pub fn beam_2006(renderer: &mut Renderer, cells: u32) -> Result<Texture> {
    let scene = beam(1);
    let grid = Grid::new(DVec3::ZERO, EDGES, cells)?;
    let going = &mut |_: f32| ControlFlow::Continue(());
    let volume = renderer.bake(&scene, grid, CellValue::Center, going)?;
    Texture::of(&volume, Storage::Emission, scene.one_color())
}

impl Cell2006 {
    /// Makes the cell's scene, with the beam's cells unless it needs none.
    #[must_use]
    pub fn scene(&self, texture: &Texture) -> Scene {
        let mut scene = beam(self.resolution);
        if self.method == Method2006::RayCasting {
            return scene;
        }
        scene.segments.clear();
        scene.spheres.clear();
        scene.integration.volumes = match self.method {
            Method2006::Slices => VolumeMethod::Slices { count: 256 },
            _ => VolumeMethod::Ray { step: 1.0 },
        };
        let mut volume = Volume::new(texture.clone());
        if self.method == Method2006::Billboard {
            volume.shape = VolumeShape::Billboard;
        }
        scene.volumes.push(volume);
        scene
    }

    /// Measures the cell, with the beam's cells.
    ///
    /// # Errors
    /// As [`measure`].
    pub fn measure(
        &self,
        renderer: &mut Renderer,
        texture: &Texture,
        time: Duration,
    ) -> Result<Speed> {
        measure(renderer, &self.scene(texture), time)
    }
}
