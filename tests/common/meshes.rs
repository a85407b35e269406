//! Meshes that tests make.

use energywave::scene::{Mesh, TriangleList};
use glam::DVec3;

/// A grid of so many columns and rows of corners, two triangles to a square; columns meet again where `is_closed`.
fn grid(columns: u32, rows: u32, is_closed: bool, place: impl Fn(u32, u32) -> DVec3) -> Mesh {
    let corners = (0..rows * columns).map(|index| place(index % columns, index / columns));
    let corners: Vec<DVec3> = corners.collect();
    let across = if is_closed { columns } else { columns - 1 };
    let squares = (0..(rows - 1) * across).map(|index| (index % across, index / across));
    let triangles = squares.flat_map(|(column, row)| {
        let at = |column: u32, row: u32| row * columns + column % columns;
        let [a, b] = [at(column, row), at(column + 1, row)];
        let [c, d] = [at(column, row + 1), at(column + 1, row + 1)];
        [[a, b, c], [b, d, c]]
    });
    Mesh::new(TriangleList::new(corners, triangles.collect()).unwrap())
}

/// A closed ball of radius 1 of `2 rows (2 rows - 1)` triangles and more; its poles are points.
pub fn ball(rows: u32) -> Mesh {
    let columns = 2 * rows;
    grid(columns, rows + 1, true, |column, row| {
        let turn = std::f64::consts::TAU * f64::from(column) / f64::from(columns);
        let down = std::f64::consts::PI * f64::from(row) / f64::from(rows);
        let out = if row == 0 || row == rows {
            0.0
        } else {
            down.sin()
        };
        DVec3::new(out * turn.cos(), out * turn.sin(), down.cos())
    })
}

/// Hills of `2 (corners - 1)^2` triangles, from -4 to 4 along x and y, up to 1.5 high.
pub fn hills(corners: u32) -> Mesh {
    let step = 8.0 / f64::from(corners - 1);
    grid(corners, corners, false, |column, row| {
        let (x, y) = (step * f64::from(column) - 4.0, step * f64::from(row) - 4.0);
        let large = (1.3 * x).sin() * (1.1 * y + 0.4).cos();
        let small = (7.0 * x + 2.0 * y).sin() * (9.0 * y).cos();
        DVec3::new(x, y, large + 0.15 * small)
    })
}
