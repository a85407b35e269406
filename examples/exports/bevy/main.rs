//! Draws beam.wgsl by Bevy 0.15 or 0.16 on a rectangle: put this file and rows.rs into src/, beam.wgsl into assets/.
//! Each frame of a scene that moves needs other rows, which `energywave::shader::Shader::uniforms_at` returns.

use bevy::prelude::*;
use bevy::render::render_resource::{AsBindGroup, ShaderRef};
use bevy::sprite::{Material2d, Material2dPlugin};

include!("rows.rs");

/// The uniform block of the shader.
#[derive(Asset, TypePath, AsBindGroup, Clone)]
struct Beam {
    #[uniform(0)]
    rows: [Vec4; ROWS.len()],
}

impl Material2d for Beam {
    fn fragment_shader() -> ShaderRef {
        "beam.wgsl".into()
    }
}

fn main() {
    App::new()
        .add_plugins((DefaultPlugins, Material2dPlugin::<Beam>::default()))
        .add_systems(Startup, set_up)
        .run();
}

fn set_up(mut commands: Commands, mut meshes: ResMut<Assets<Mesh>>, mut beams: ResMut<Assets<Beam>>) {
    commands.spawn(Camera2d);
    commands.spawn((
        Mesh2d(meshes.add(Rectangle::new(768.0, 432.0))),
        MeshMaterial2d(beams.add(Beam {
            rows: ROWS.map(Vec4::from_array),
        })),
    ));
}
