//! Where the core of a source is: how far it reaches in a direction, and how near it comes to a point.

use glam::DVec3;

/// The core of a source.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Core {
    /// A quadratic Bezier curve, which may be straight, or one point.
    Bezier([DVec3; 3]),
    /// A straight line through a point, or from it on.
    Line {
        point: DVec3,
        /// Of length 1.
        direction: DVec3,
        begins: bool,
    },
    Circle {
        center: DVec3,
        /// Of length 1.
        axis: DVec3,
        radius: f64,
    },
    /// Straight lines from corner to corner; of a curved path roughly.
    Chain(Vec<DVec3>),
}

/// Pieces of a curve in which its least distance is sought.
const PIECES: u32 = 64;

impl Core {
    /// Makes the core of a point.
    pub(super) fn point(point: DVec3) -> Self {
        Self::Bezier([point; 3])
    }

    /// Makes the core of a straight line between two points.
    pub(super) fn between(from: DVec3, to: DVec3) -> Self {
        Self::Bezier([from, (from + to) / 2.0, to])
    }

    /// Returns the lowest and the highest coordinates of its points; of a line without end those of its point.
    pub(crate) fn bounds(&self) -> (DVec3, DVec3) {
        if let Self::Line { point, .. } = self {
            return (*point, *point);
        }
        let reach = |sign: f64| DVec3::from(DVec3::AXES.map(|axis| self.reach(sign * axis)));
        (-reach(-1.0), reach(1.0))
    }

    /// Returns a ball that it lies in, centre and radius; of a line without end there is none.
    pub(crate) fn ball(&self) -> Option<(DVec3, f64)> {
        match self {
            Self::Bezier(points) => Some(ball_around(points.iter().map(|point| (*point, 0.0)))),
            Self::Chain(corners) => Some(ball_around(corners.iter().map(|point| (*point, 0.0)))),
            Self::Circle { center, radius, .. } => Some((*center, *radius)),
            Self::Line { .. } => None,
        }
    }

    /// Returns how far it reaches in a direction of length 1, from the origin; infinite for a line that goes on.
    pub(crate) fn reach(&self, direction: DVec3) -> f64 {
        match *self {
            Self::Chain(ref corners) => {
                let along = corners.iter().map(|corner| corner.dot(direction));
                along.fold(f64::NEG_INFINITY, f64::max)
            }
            Self::Bezier(points) => {
                let [a, b, c] = points.map(|point| point.dot(direction));
                // Where the derivative of (1-t)^2 a + 2t(1-t) b + t^2 c is 0.
                let t = ((a - b) / (a - 2.0 * b + c)).clamp(0.0, 1.0);
                let inside = bezier([a, b, c], if t.is_nan() { 0.0 } else { t });
                a.max(c).max(inside)
            }
            Self::Line {
                point,
                direction: along,
                begins,
            } => match along.dot(direction) {
                ahead if ahead > 0.0 || (ahead < 0.0 && !begins) => f64::INFINITY,
                _ => point.dot(direction),
            },
            Self::Circle {
                center,
                axis,
                radius,
            } => {
                let across = (1.0 - axis.dot(direction).powi(2)).max(0.0).sqrt();
                center.dot(direction) + radius * across
            }
        }
    }

    /// Returns a distance from a point than which none of its points is nearer: the least one, or for a curve a little
    /// less.
    pub(crate) fn least_distance(&self, from: DVec3) -> f64 {
        match *self {
            Self::Chain(ref corners) => {
                let distances = corners.windows(2).map(|pair| {
                    let span = pair[1] - pair[0];
                    let share = (from - pair[0]).dot(span) / span.length_squared();
                    from.distance(pair[0] + span * share.clamp(0.0, 1.0))
                });
                let first = corners
                    .first()
                    .map_or(f64::INFINITY, |it| it.distance(from));
                distances.fold(first, f64::min)
            }
            Self::Bezier(points) => {
                let [a, b, c] = points;
                let speed = 2.0 * (b - a).length().max((c - b).length());
                let sampled = (0..=PIECES).map(|k| {
                    let t = f64::from(k) / f64::from(PIECES);
                    bezier(points, t).distance(from)
                });
                let nearest = sampled.fold(f64::INFINITY, f64::min);
                (nearest - 0.5 * speed / f64::from(PIECES)).max(0.0)
            }
            Self::Line {
                point,
                direction,
                begins,
            } => {
                let along = (from - point).dot(direction);
                let along = if begins { along.max(0.0) } else { along };
                from.distance(point + along * direction)
            }
            Self::Circle {
                center,
                axis,
                radius,
            } => {
                let height = (from - center).dot(axis);
                let across = (from - center - height * axis).length();
                (across - radius).hypot(height)
            }
        }
    }
}

/// Returns a ball around balls: centres and radii.
pub(crate) fn ball_around(balls: impl Iterator<Item = (DVec3, f64)> + Clone) -> (DVec3, f64) {
    let centers = || balls.clone().map(|(center, _)| center);
    let low = centers().reduce(DVec3::min).unwrap_or_default();
    let high = centers().reduce(DVec3::max).unwrap_or_default();
    let middle = 0.5 * (low + high);
    let far = |(center, radius): (DVec3, f64)| center.distance(middle) + radius;
    (middle, balls.map(far).fold(0.0, f64::max))
}

fn bezier<T>([a, b, c]: [T; 3], t: f64) -> T
where
    T: std::ops::Mul<f64, Output = T> + std::ops::Add<Output = T>,
{
    a * ((1.0 - t) * (1.0 - t)) + b * (2.0 * t * (1.0 - t)) + c * (t * t)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn v(x: f64, y: f64, z: f64) -> DVec3 {
        DVec3::new(x, y, z)
    }

    #[test]
    fn reaches_and_distances_are_those_of_the_points() {
        let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
        let point = Core::point(v(1.0, 2.0, 3.0));
        assert_eq!(
            (point.reach(z), point.least_distance(v(1.0, 2.0, 0.0))),
            (3.0, 3.0)
        );
        let line = |begins| Core::Line {
            point: v(0.0, 0.0, 1.0),
            direction: x,
            begins,
        };
        assert_eq!(
            (
                line(false).reach(x),
                line(false).reach(-x),
                line(false).reach(z)
            ),
            (f64::INFINITY, f64::INFINITY, 1.0)
        );
        assert_eq!(
            (line(true).reach(x), line(true).reach(-x)),
            (f64::INFINITY, 0.0)
        );
        assert_eq!(line(false).least_distance(v(-4.0, 0.0, 4.0)), 3.0);
        assert_eq!(line(true).least_distance(v(-4.0, 0.0, 4.0)), 5.0);
        let ring = Core::Circle {
            center: v(0.0, 0.0, 1.0),
            axis: z,
            radius: 2.0,
        };
        assert_eq!((ring.reach(z), ring.reach(x)), (1.0, 2.0));
        assert_eq!(ring.least_distance(v(5.0, 0.0, 5.0)), 5.0);
        let arc = Core::Bezier([v(-1.0, 0.0, 0.0), v(0.0, 2.0, 0.0), v(1.0, 0.0, 0.0)]);
        assert_eq!((arc.reach(y), arc.reach(x), arc.reach(-y)), (1.0, 1.0, 0.0));
        let (center, radius) = arc.ball().unwrap();
        assert_eq!((center, radius), (v(0.0, 1.0, 0.0), 2.0_f64.sqrt()));
        assert_eq!(ring.ball(), Some((v(0.0, 0.0, 1.0), 2.0)));
        assert_eq!(line(true).ball(), None);
        let near = arc.least_distance(v(0.0, 4.0, 0.0));
        assert!(near <= 3.0 && near > 2.95, "{near}");
    }
}
