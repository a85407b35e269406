//! Particles as light, in float64 and from their definition alone: `light kernel(d/h)`, d the distance to a point or to
//! a segment, times what fading leaves, by adaptive quadrature. Where an element's light begins and ends along a ray is
//! found by samples and bisection; no formula of the kernels is used.

use glam::DVec3;

use super::quadrature::integrate;
use super::{Integrand, RELATIVE_ERROR};
use crate::scene::{LightElement, MetaballKernel, Ray, Scene};
use crate::threads;

/// Samples of the stretch of a ray next to an element, in which changes from dark to light are sought.
const SAMPLES: u32 = 64;

/// Bisections.
const HALVINGS: u32 = 50;

/// An element, as a segment: of a ball it has no length.
#[derive(Debug, Clone, Copy)]
struct Body {
    ends: [DVec3; 2],
    radii: [f64; 3],
    light: DVec3,
    kernel: MetaballKernel,
}

/// All particles of a scene.
#[derive(Debug)]
pub(super) struct Particles {
    bodies: Vec<Body>,
    integrand: Integrand,
}

impl Body {
    fn ball(center: DVec3, radius: f64, light: DVec3, kernel: MetaballKernel) -> Self {
        Self {
            ends: [center; 2],
            radii: [radius; 3],
            light,
            kernel,
        }
    }

    /// Returns the distance of a point from the core, as a share of the radius there.
    fn share(&self, point: DVec3) -> f64 {
        let [from, to] = self.ends;
        let way = to - from;
        let length2 = way.length_squared();
        let along = match length2 > 0.0 {
            true => ((point - from).dot(way) / length2).clamp(0.0, 1.0),
            false => 0.5,
        };
        let [first, middle, last] = self.radii;
        let radius = match along < 0.5 {
            true => first + (middle - first) * 2.0 * along,
            false => middle + (last - middle) * (2.0 * along - 1.0),
        };
        point.distance(from + along * way) / radius
    }

    fn at(&self, point: DVec3) -> f64 {
        let share = self.share(point).min(1.0);
        match self.kernel {
            MetaballKernel::Cone => (1.0 - share).powi(2),
            MetaballKernel::Smooth => (1.0 - share * share).powi(3),
        }
    }

    /// Returns the integral over s in [0, end].
    fn integral(&self, ray: &Ray, end: f64, integrand: &Integrand) -> f64 {
        let [from, to] = self.ends;
        let reach = self.radii.into_iter().fold(0.0, f64::max) + 0.5 * from.distance(to);
        let middle = ray.nearest_to(0.5 * (from + to));
        let aside = ray.at(middle).distance(0.5 * (from + to));
        let length = ray.span.length();
        let half = (reach * reach - aside * aside).max(0.0).sqrt() / length;
        if half == 0.0 || middle + half <= 0.0 || middle - half >= end {
            return 0.0;
        }
        let (low, high) = (middle - half, middle + half);
        let mut breaks = vec![low, high, middle];
        let place = |index: u32| low + (high - low) * f64::from(index) / f64::from(SAMPLES);
        let is_lit = |s: f64| self.share(ray.at(s)) < 1.0;
        // Planes through ends and middle, where the core changes.
        let way = to - from;
        for share in [0.0, 0.5, 1.0] {
            let along = ray.span.dot(way);
            if along != 0.0 {
                breaks.push((from + share * way - ray.origin).dot(way) / along);
            }
        }
        breaks.push(self.nearest(ray, low, high));
        let mut places: Vec<f64> = (0..=SAMPLES)
            .map(place)
            .chain(breaks.iter().copied())
            .collect();
        places.sort_by(f64::total_cmp);
        for pair in places.windows(2) {
            let (mut one, mut other) = (pair[0], pair[1]);
            let lit = is_lit(one);
            if lit == is_lit(other) {
                continue;
            }
            for _ in 0..HALVINGS {
                let half = 0.5 * (one + other);
                match is_lit(half) == lit {
                    true => one = half,
                    false => other = half,
                }
            }
            breaks.push(0.5 * (one + other));
        }
        let at = |s: f64| self.at(ray.at(s)) * integrand.fading(ray, s);
        integrate(at, &mut breaks, end, RELATIVE_ERROR).value
    }

    /// Returns the place where the core is nearest, by thirds: along a ray the distance to a segment has one valley.
    fn nearest(&self, ray: &Ray, mut low: f64, mut high: f64) -> f64 {
        for _ in 0..100 {
            let (one, other) = ((2.0 * low + high) / 3.0, (low + 2.0 * high) / 3.0);
            match self.distance(ray.at(one)) < self.distance(ray.at(other)) {
                true => high = other,
                false => low = one,
            }
        }
        0.5 * (low + high)
    }

    fn distance(&self, point: DVec3) -> f64 {
        let even = Self {
            radii: [1.0; 3],
            ..*self
        };
        even.share(point)
    }
}

impl Particles {
    pub(super) fn new(scene: &Scene, integrand: Integrand) -> Self {
        let mut bodies = Vec::new();
        for particles in scene.particles.iter() {
            particles.for_each(0..particles.points.len(), |center, radius, light| {
                bodies.push(Body::ball(center, radius, light, particles.kernel));
            });
        }
        bodies.extend(scene.light_elements.iter().map(|element| match *element {
            LightElement::Ball {
                center,
                radius,
                light,
            } => Body::ball(center, radius, light, MetaballKernel::Cone),
            LightElement::Streak { ends, radii, light } => Body {
                ends,
                radii,
                light,
                kernel: MetaballKernel::Cone,
            },
        }));
        Self { bodies, integrand }
    }

    pub(super) fn len(&self) -> usize {
        self.bodies.len()
    }

    /// Returns the linear RGB along a ray, over s in [0, end].
    pub(super) fn light(&self, ray: &Ray, end: f64) -> DVec3 {
        let of = |body: &Body| body.light * body.integral(ray, end, &self.integrand);
        self.bodies.iter().map(of).sum()
    }
}

/// Returns the linear RGB that the particles of a scene without waves give to whole rays, in the scene's measure.
pub(crate) fn particle_light(scene: &Scene, rays: &[Ray]) -> Vec<DVec3> {
    let particles = Particles::new(scene, Integrand::of(scene));
    let mut lights = vec![DVec3::ZERO; rays.len()];
    threads::for_each_chunk(&mut lights, 1, |index, light| {
        let ray = &rays[index];
        let scale = scene.integration.scale(ray.span.length());
        light.fill(particles.light(ray, 1.0) * scale);
    });
    lights
}
