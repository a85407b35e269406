//! Light balls (Sakai 2006, section 5): balls of shells, each of one colour and alpha, white within and paler without;
//! radii are counted in cells, and what a cell gives off is alpha times its colour.

use glam::DVec3;

use super::Texture;
use super::texture::{Storage, TextureOrigin, count};

/// A light ball as the thesis describes it.
#[derive(Debug, Clone, PartialEq)]
pub struct LightBall {
    /// Where each shell ends, cells from the middle, growing.
    pub radii: [f64; 3],
    /// Of each shell, linear RGB.
    pub colors: [DVec3; 3],
    /// Of each shell: light a world unit of length.
    pub alphas: [f64; 3],
    /// Cells along each edge of the cube around it.
    pub cells: u32,
}

impl Default for LightBall {
    /// Returns the thesis' ball: white up to 3 cells, blue up to 6, pale up to 7.
    fn default() -> Self {
        Self {
            radii: [3.0, 6.0, 7.0],
            colors: [
                DVec3::ONE,
                DVec3::new(0.3, 0.5, 1.0),
                DVec3::new(0.1, 0.2, 0.5),
            ],
            alphas: [0.9, 0.5, 0.1],
            cells: 16,
        }
    }
}

impl LightBall {
    /// Fills its cells.
    ///
    /// # Errors
    /// What is wrong with it, and with which of its keys.
    pub(crate) fn texture(&self) -> std::result::Result<Texture, (&'static str, String)> {
        self.check()?;
        let cells = [self.cells; 3];
        let edge = self.cells as usize;
        let mut values = vec![0.0; 3 * count(cells)];
        let plane = count(cells);
        for place in 0..plane {
            let cell = [place % edge, place / edge % edge, place / edge / edge];
            let from_middle = DVec3::from(cell.map(|it| it as f64 + 0.5)) - 0.5 * edge as f64;
            let distance = from_middle.length();
            let shell = self.radii.iter().position(|radius| distance <= *radius);
            let Some(shell) = shell else { continue };
            let light = (self.alphas[shell] * self.colors[shell]).to_array();
            for (channel, light) in light.into_iter().enumerate() {
                values[channel * plane + place] = light as f32;
            }
        }
        let texture = Texture::checked(cells, values, Storage::Emission);
        let texture = texture.map_err(|wrong| ("colors", wrong))?;
        Ok(texture.with_origin(TextureOrigin::LightBall(self.clone())))
    }

    fn check(&self) -> std::result::Result<(), (&'static str, String)> {
        let [first, second, third] = self.radii;
        let grow = first > 0.0 && second >= first && third >= second && third.is_finite();
        if !grow {
            let message = format!(
                "{:?}; each shell ends at its radius, the first above 0, none before another",
                self.radii
            );
            return Err(("radii", message));
        }
        if !(1..=512).contains(&self.cells) {
            let message = format!(
                "{}; a light ball has 1 to 512 cells along an edge",
                self.cells
            );
            return Err(("cells", message));
        }
        if !self.alphas.iter().all(|it| (0.0..=1e9).contains(it)) {
            let message = format!("{:?}; light is not taken away: 0 or more", self.alphas);
            return Err(("alphas", message));
        }
        let is_color = |it: &DVec3| it.is_finite() && it.min_element() >= 0.0;
        match self.colors.iter().all(is_color) {
            true => Ok(()),
            false => Err(("colors", "colours are 0 or more".to_owned())),
        }
    }
}
