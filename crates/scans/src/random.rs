//! Numbers by chance, the same for the same seed on every machine.
//! (SplitMix64 is five lines; a crate of generators would be a dependency of the program for them.)

use crate::exact::ln;
use crate::vector::{V3, unit};

/// Steele, Lea and Flood, Fast Splittable Pseudorandom Number Generators, OOPSLA 2014.
#[derive(Debug, Clone)]
pub(crate) struct Random {
    state: u64,
    spare: Option<f64>,
}

impl Random {
    /// Of a seed, and of what is drawn with it: different purposes do not draw the same numbers.
    pub fn new(seed: u64, purpose: u64) -> Self {
        let mut random = Self { state: purpose << 32 ^ seed, spare: None };
        random.state = random.next();
        random
    }

    fn next(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.state ^ self.state >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ z >> 31
    }

    /// From 0 to below 1.
    pub fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }

    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Below `count`.
    pub fn index(&mut self, count: usize) -> usize {
        ((self.unit() * count as f64) as usize).min(count.saturating_sub(1))
    }

    /// Of mean 0 and variance 1: Marsaglia's polar method, two at a time.
    pub fn normal(&mut self) -> f64 {
        if let Some(spare) = self.spare.take() {
            return spare;
        }
        loop {
            let [u, v] = [0; 2].map(|_| self.between(-1.0, 1.0));
            let square = u * u + v * v;
            if square > 0.0 && square < 1.0 {
                let factor = (-2.0 * ln(square) / square).sqrt();
                self.spare = Some(v * factor);
                return u * factor;
            }
        }
    }

    pub fn normals(&mut self) -> V3 {
        [0; 3].map(|_| self.normal())
    }

    /// A direction, all alike.
    pub fn direction(&mut self) -> V3 {
        unit(self.normals())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A standard error of 100 000 numbers is 0.0032 for the mean and 0.0045 for the variance; the share within one
    /// and two deviations is the normal distribution's.
    #[test]
    fn normal_numbers_have_their_moments_and_shares() {
        let mut random = Random::new(1, 1);
        let numbers: Vec<f64> = (0..100_000).map(|_| random.normal()).collect();
        let mean_of = |of: fn(f64) -> f64| numbers.iter().map(|&x| of(x)).sum::<f64>() / 1e5;
        assert!(mean_of(|x| x).abs() < 0.01, "{}", mean_of(|x| x));
        assert!((mean_of(|x| x * x) - 1.0).abs() < 0.015, "{}", mean_of(|x| x * x));
        let within = |limit: f64| numbers.iter().filter(|x| x.abs() < limit).count() as f64 / 1e5;
        assert!((within(1.0) - 0.6827).abs() < 0.005, "{}", within(1.0));
        assert!((within(2.0) - 0.9545).abs() < 0.003, "{}", within(2.0));
    }

    #[test]
    fn seeds_and_purposes_differ() {
        let first = |seed, purpose| Random::new(seed, purpose).unit();
        let all = [first(0, 0), first(1, 0), first(0, 1), first(1, 1)];
        for (at, a) in all.iter().enumerate() {
            assert!(all[..at].iter().all(|b| a != b) && (0.0..1.0).contains(a), "{all:?}");
        }
    }
}
