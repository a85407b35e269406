//! Whether all sources of a scene give off light of one colour: one number then says what a point of space gives off.

use glam::DVec3;

use super::Scene;

/// How far colours may be apart that are one.
const ERROR: f64 = 1e-9;

impl Scene {
    /// Returns the colour of the light of all sources, linear RGB, its largest channel 1; `None` where they have
    /// several, or `colors` along a core, or there is no light.
    #[must_use]
    pub fn one_color(&self) -> Option<DVec3> {
        let (mut first, mut is_one) = (None, true);
        self.for_each_emission(&mut |emission| {
            let channels = emission.to_array();
            let largest =
                channels.into_iter().fold(
                    0.0_f64,
                    |most, it| {
                        if it.abs() > most.abs() { it } else { most }
                    },
                );
            if largest != 0.0 {
                let color = emission / largest;
                is_one &= color.abs_diff_eq(*first.get_or_insert(color), ERROR);
            }
        });
        first.filter(|_| is_one)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Camera, LightPath, Sphere, Torus};

    #[test]
    fn brightness_is_no_colour_and_colours_along_a_core_are() {
        let mut scene = Scene::new(Camera::new(-4.0 * DVec3::Y, DVec3::ZERO));
        assert_eq!(scene.one_color(), None);
        let color = DVec3::new(0.5, 0.25, 0.0);
        let sphere = |coefficient: f64| Sphere {
            coefficient,
            color: coefficient.abs() * color,
            ..Sphere::default()
        };
        scene.spheres = vec![sphere(2.0), sphere(-1.0), sphere(0.0)].into();
        let one = DVec3::new(1.0, 0.5, 0.0);
        assert_eq!(scene.one_color(), Some(one));
        let mut path = LightPath::new(vec![DVec3::ZERO, DVec3::X]);
        path.colors = Some(vec![one, DVec3::ONE]);
        scene.paths.push(path);
        assert_eq!(scene.one_color(), None);
        scene.paths.pop();
        scene.tori.push(Torus::new(1.0));
        assert_eq!(scene.one_color(), None, "a white ring");
    }
}
