//! Two facing plates, of which a slanting sun lights one: view factors, and the sum of bounces.

use super::*;

/// Half a plate's side, and the distance of both.
const HALF: f64 = 1.0;
const GAP: f64 = 1.0;
/// Up at the upper plate, past the lower one.
const VIEW: View =
    View { eye: [0.2, 0.1, 3.6], target: [0.0, 1.0, 0.2], fov: 22.0, size: [48, 36] };

/// Nodes and weights of Gauss's rule of this order on [-1, 1], by Newton's method on Legendre's polynomial.
fn gauss(order: usize) -> Vec<(f64, f64)> {
    (0..order)
        .map(|i| {
            let mut x = (PI * (i as f64 + 0.75) / (order as f64 + 0.5)).cos();
            let mut slope = 1.0;
            for _ in 0..50 {
                let (mut before, mut now) = (1.0, x);
                for n in 2..=order {
                    let n = n as f64;
                    (before, now) = (now, ((2.0 * n - 1.0) * x * now - (n - 1.0) * before) / n);
                }
                slope = order as f64 * (x * now - before) / (x * x - 1.0);
                x -= now / slope;
            }
            (x, 2.0 / ((1.0 - x * x) * slope * slope))
        })
        .collect()
}

/// How much of what leaves a place on one plate meets the other around another place, for each area: cos² / (π d²).
fn kernel(a: [f64; 2], b: [f64; 2]) -> f64 {
    let square = GAP * GAP + (a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2);
    GAP * GAP / (PI * square * square)
}

/// The view factor of a place under a plate's corner, which is so far to each side of it, in closed form.
fn corner(a: f64, b: f64) -> f64 {
    let (p, q) = (a.hypot(GAP), b.hypot(GAP));
    (a / p * (b / p).atan() + b / q * (a / q).atan()) / (2.0 * PI)
}

/// That of a place for the whole other plate.
fn factor([x, z]: [f64; 2]) -> f64 {
    let sides = |at: f64| [HALF - at, HALF + at];
    sides(x).iter().flat_map(|&a| sides(z).map(|b| corner(a, b))).sum()
}

/// Nodes of a plate with their weights, and the light at them: that of each order over the sun's on the lower plate. Light of
/// odd orders is on the upper plate.
struct Plates {
    nodes: Vec<([f64; 2], f64)>,
    orders: Vec<Vec<f64>>,
    albedo: f64,
}

impl Plates {
    fn new(albedo: f64, bounces: usize) -> Self {
        let rule = gauss(16);
        let nodes = (rule.iter())
            .flat_map(|&(x, wx)| {
                rule.iter().map(move |&(z, wz)| ([HALF * x, HALF * z], HALF * HALF * wx * wz))
            })
            .collect();
        let mut plates = Self { nodes, orders: Vec::new(), albedo };
        plates.orders.push(vec![1.0; plates.nodes.len()]);
        for order in 1..bounces {
            let next = plates.nodes.iter().map(|(at, _)| plates.of_order(*at, order)).collect();
            plates.orders.push(next);
        }
        plates
    }

    /// Light of this order, at least 1.
    fn of_order(&self, at: [f64; 2], order: usize) -> f64 {
        let light = self.nodes.iter().zip(&self.orders[order - 1]);
        let terms = light.map(|((from, weight), light)| weight * kernel(at, *from) * light);
        self.albedo * terms.sum::<f64>()
    }

    /// On the upper plate.
    fn irradiance(&self, at: [f64; 2]) -> f64 {
        (1..=self.orders.len()).step_by(2).map(|order| self.of_order(at, order)).sum()
    }
}

#[test]
fn the_rule_gives_the_closed_form() {
    for place in [[0.0, 0.0], [0.4, -0.7], [0.9, 0.9]] {
        let (rule, closed) = (Plates::new(1.0, 1).irradiance(place), factor(place));
        assert!((rule - closed).abs() < 1e-9, "{rule}, {closed}");
    }
}

/// A texture that is white where the plates are, and black around: its edges are sharper than a lattice's.
fn square() -> Arc<Image> {
    let count = 240;
    let inside = |i: u32| (20..220).contains(&i);
    let texel = |i: u32| [if inside(i % count) && inside(i / count) { 0.8 } else { 0.0 }; 3];
    let texels = film::Texels::Linear((0..count * count).map(texel).collect());
    Arc::new(Image { width: count, height: count, texels })
}

/// The sun is so low that the upper plate's shadow falls beside the lower one. The edges of the texture, a texel of 0.01
/// wide, are the floor.
#[test]
fn facing_plates_light_each_other() {
    let (sin, cos) = 15f64.to_radians().sin_cos();
    let albedo = 0.8;
    for bounces in [1, 2, 16] {
        let text = format!(
            "{}samples = 128\nfilter_width = 0.2\n[render]\nintegrator = \"path\"\nmax_bounces = {bounces}\n\
             [[lights]]\nkind = \"directional\"\ndirection = [{}, {}, 0.0]\nirradiance = [5.0, 5.0, 5.0]\n\
             [[objects]]\npoints = \"plates.ply\"\nmaterial = {{ texture = \"square.png\" }}\n",
            VIEW.text(),
            -cos,
            -sin
        );
        let plates = [0.0, GAP].iter().flat_map(|&y| lattice(1.2 * HALF, 0.1, y)).collect();
        let images = SceneImages { environment: None, textures: vec![Some(square())] };
        let plan = plan_with(&text, &[set_of(plates)], &images);
        let truth = Plates::new(albedo, bounces);
        check(&format!("plates, {bounces} bounces"), &plan, 1e-4, |pixel| {
            let [x, _, z] = on_level(&VIEW, pixel, GAP)?;
            let below = on_level(&VIEW, pixel, 0.0);
            let clear = below.is_none_or(|[x, _, z]| x.abs().max(z.abs()) > 1.3 * HALF);
            let seen = x.abs().max(z.abs()) < 0.9 * HALF && clear;
            let direct = 5.0 * sin;
            seen.then(|| [albedo * FRAC_1_PI * direct * truth.irradiance([x, z]); 3])
        });
    }
}
