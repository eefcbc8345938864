//! Twin of `glsl/shared/optics.glsl`: directions of reflected and refracted rays.

use crate::real::{Real, V3};

/// The direction of a mirrored ray.
#[must_use]
pub fn reflected<R: Real>(d: V3<R>, n: V3<R>) -> V3<R> {
    (d - n.times(R::of(2.0) * n.dot(d))).normalize()
}

/// What Snell's law makes of a ray.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Refraction<R> {
    /// Refracted, or reflected where nothing is refracted.
    pub direction: V3<R>,
    /// Total internal reflection.
    pub total: bool,
    /// Of unpolarised light, by Fresnel's equations; 1 where total.
    pub reflectance: R,
}

/// A ray from index n1 to n2; the normal faces the side that it comes from.
#[must_use]
pub fn refraction<R: Real>(d: V3<R>, n: V3<R>, n1: R, n2: R) -> Refraction<R> {
    let (zero, one) = (R::of(0.0), R::of(1.0));
    let eta = n1 / n2;
    let incident = (-n.dot(d)).max(zero).min(one);
    let square = one - (eta * eta) * (one - incident * incident);
    if square <= zero {
        return Refraction { direction: reflected(d, n), total: true, reflectance: one };
    }
    let transmitted = square.sqrt();
    Refraction {
        direction: (d.times(eta) + n.times(eta * incident - transmitted)).normalize(),
        total: false,
        reflectance: fresnel_reflectance([n1, incident], [n2, transmitted]),
    }
}

/// The mean of the two polarisations' reflectances, from index and cosine on either side.
fn fresnel_reflectance<R: Real>([n1, incident]: [R; 2], [n2, transmitted]: [R; 2]) -> R {
    let across = (n1 * incident - n2 * transmitted) / (n1 * incident + n2 * transmitted);
    let along = (n2 * incident - n1 * transmitted) / (n2 * incident + n1 * transmitted);
    R::of(0.5) * (across * across + along * along)
}

/// What is reflected of unpolarised light from index n1 to a higher n2, by the cosine of its angle; never all of it but at
/// 90 degrees.
#[must_use]
pub fn reflectance_into<R: Real>(incident: R, n1: R, n2: R) -> R {
    let one = R::of(1.0);
    let eta = n1 / n2;
    let transmitted = (one - (eta * eta) * (one - incident * incident)).sqrt();
    fresnel_reflectance([n1, incident], [n2, transmitted])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ray(degrees: f64) -> V3<f64> {
        let (sine, cosine) = degrees.to_radians().sin_cos();
        V3([sine, -cosine, 0.0])
    }

    const UP: V3<f64> = V3([0.0, 1.0, 0.0]);

    #[test]
    fn refraction_obeys_snell_and_turns_total_at_the_critical_angle() {
        for degrees in [0.0, 20.0, 60.0, 89.0] {
            let bent = refraction(ray(degrees), UP, 1.0, 1.5);
            let sine = degrees.to_radians().sin() / 1.5;
            assert!((bent.direction.x() - sine).abs() < 1e-14 && bent.direction.y() < 0.0);
        }
        let critical = (1.0f64 / 1.5).asin().to_degrees();
        assert!(!refraction(ray(critical - 1e-6), UP, 1.5, 1.0).total);
        let total = refraction(ray(critical + 1e-6), UP, 1.5, 1.0);
        assert!(total.total && total.reflectance == 1.0 && total.direction.y() > 0.0);
    }

    /// Closed forms: ((n − 1)/(n + 1))² at normal incidence; at Brewster's angle half of the light
    /// polarised across, ((n² − 1)/(n² + 1))² / 2.
    #[test]
    fn fresnel_at_normal_incidence_and_at_brewsters_angle() {
        let n = 1.5f64;
        let normal = refraction(ray(0.0), UP, 1.0, n).reflectance;
        assert!((normal - ((n - 1.0) / (n + 1.0)).powi(2)).abs() < 1e-14);
        let brewster = refraction(ray(n.atan().to_degrees()), UP, 1.0, n).reflectance;
        let across = ((n * n - 1.0) / (n * n + 1.0)).powi(2);
        assert!((brewster - 0.5 * across).abs() < 1e-14);
    }

    #[test]
    fn a_mirrored_ray_leaves_at_the_angle_at_which_it_came() {
        let out = reflected(ray(37.0), UP);
        assert!((out.x() - ray(37.0).x()).abs() < 1e-15 && (out.y() + ray(37.0).y()).abs() < 1e-15);
    }
}
