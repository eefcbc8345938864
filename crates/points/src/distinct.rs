//! Distinct positions of points that come one after the other: how many points lie where an earlier
//! one does, and a sample of the places, in memory that does not grow with the points.
//!
//! Each position has a hash of 64 bits. While there are few positions, all hashes are held; when there are
//! too many, only those below half of the range are kept, then below a quarter, and so on. What is
//! kept is a fair sample of the positions, however often each occurs, and depends on nothing but them. Two of
//! a hundred million positions share a hash once in four thousand files.

/// Hashes that are held at most.
const MOST_HASHES: usize = 1 << 22;
/// Positions of the sample at most.
pub(crate) const MOST_SAMPLED: usize = 1 << 17;

/// Positions that were seen.
pub(crate) struct Distinct {
    /// Hashes of what lies in the part of the range that is held, each at the first free place from the
    /// one that its low bits name; 0 is a free place.
    table: Vec<u64>,
    held: usize,
    /// Leading zeros that a hash needs to be held.
    level: u32,
    /// Points by the leading zeros of their hashes.
    points: [u64; 65],
    sample: Vec<(u64, [f64; 3])>,
    /// Leading zeros that a hash needs to be in the sample: no fewer than `level`.
    sample_level: u32,
    most_hashes: usize,
}

impl Distinct {
    pub(crate) fn new() -> Self {
        Self::holding(MOST_HASHES)
    }

    /// `most_hashes` is a power of two, and no less than what is sampled.
    fn holding(most_hashes: usize) -> Self {
        Self {
            table: vec![0; 1 << 10],
            held: 0,
            level: 0,
            points: [0; 65],
            sample: Vec::new(),
            sample_level: 0,
            most_hashes,
        }
    }

    /// Takes the position of the next point.
    pub(crate) fn see(&mut self, position: &[f64; 3]) {
        let hash = hash_of(position);
        let zeros = hash.leading_zeros();
        self.points[zeros as usize] += 1;
        if zeros < self.level || !self.insert(hash) {
            return;
        }
        if zeros >= self.sample_level {
            self.sample.push((hash, *position));
            while self.sample.len() > MOST_SAMPLED {
                self.sample_level += 1;
                let level = self.sample_level;
                self.sample.retain(|(hash, _)| hash.leading_zeros() >= level);
            }
        }
        while self.held > self.most_hashes {
            self.level += 1;
            // Hashes that were there once are not new again, so the sample must not ask for them.
            self.sample_level = self.sample_level.max(self.level);
            self.rebuild(self.table.len());
        }
        if self.held > self.table.len() / 2 {
            self.rebuild(2 * self.table.len());
        }
    }

    /// Adds a hash; `false` if it was there.
    fn insert(&mut self, hash: u64) -> bool {
        let mask = self.table.len() - 1;
        let mut place = hash as usize & mask;
        loop {
            match self.table[place] {
                0 => break,
                other if other == hash => return false,
                _ => place = (place + 1) & mask,
            }
        }
        self.table[place] = hash;
        self.held += 1;
        true
    }

    /// Puts what is to be held into a table of `places`.
    fn rebuild(&mut self, places: usize) {
        let level = self.level;
        let kept = |&hash: &u64| hash != 0 && hash.leading_zeros() >= level;
        let hashes: Vec<u64> = self.table.iter().copied().filter(kept).collect();
        // The old one goes first, so that both are never held.
        self.table = Vec::new();
        self.table = vec![0; places];
        self.held = 0;
        for hash in hashes {
            self.insert(hash);
        }
    }

    /// How many points lie where an earlier one does, and whether that was counted: else it is an
    /// estimate, whose error is about the root of the number times that of the sampled share.
    pub(crate) fn coincident(&self) -> (u64, bool) {
        let points: u64 = self.points[self.level as usize..].iter().sum();
        ((points - self.held as u64) << self.level, self.level == 0)
    }

    /// Whether [`sample`](Self::sample) has every position.
    pub(crate) fn sample_is_whole(&self) -> bool {
        self.sample_level == 0
    }

    /// A sample of the positions, each once: all of them up to 2¹⁷, of more at least half as many. In the
    /// order of their hashes, which is without any order in space, so that a part of it is a sample too.
    pub(crate) fn sample(mut self) -> Vec<[f64; 3]> {
        self.sample.sort_unstable_by_key(|&(hash, _)| hash);
        self.positions()
    }

    /// The positions of the sample as they came.
    pub(crate) fn positions(&self) -> Vec<[f64; 3]> {
        self.sample.iter().map(|&(_, position)| position).collect()
    }
}

/// Never 0. Positions that compare as equal have the same.
fn hash_of(position: &[f64; 3]) -> u64 {
    let mixed = position.iter().fold(0x243f_6a88_85a3_08d3, |hash: u64, &coordinate| {
        // Adding 0 makes -0 the same as 0.
        let bits = (coordinate + 0.0).to_bits();
        let product = u128::from(hash ^ bits ^ 0x9e37_79b9_7f4a_7c15) * 0xd6e8_feb8_6659_fd93;
        (product as u64) ^ (product >> 64) as u64 ^ bits.rotate_left(32)
    });
    // The finaliser of MurmurHash3: each bit of its input decides over each of the result.
    let mixed = (mixed ^ mixed >> 33).wrapping_mul(0xff51_afd7_ed55_8ccd);
    let mixed = (mixed ^ mixed >> 33).wrapping_mul(0xc4ce_b9fe_1a85_ec53);
    (mixed ^ mixed >> 33).max(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lattice(side: u32) -> impl Iterator<Item = [f64; 3]> {
        let place = move |i: u32| [i % side, i / side % side, i / side / side].map(f64::from);
        (0..side.pow(3)).map(place)
    }

    #[test]
    fn every_point_that_lies_where_an_earlier_one_does_is_counted() {
        let mut distinct = Distinct::new();
        for copy in 0..8 {
            lattice(20).for_each(|position| distinct.see(&position));
            assert_eq!(distinct.coincident(), (8000 * copy, true));
        }
        // 0 and -0 are one place.
        distinct.see(&[-0.0, 1.0, -0.0]);
        assert_eq!(distinct.coincident(), (56_001, true));
        assert!(distinct.sample_is_whole());
        let mut sample = distinct.sample();
        sample.sort_unstable_by(|a, b| a.partial_cmp(b).unwrap());
        let mut expected: Vec<_> = lattice(20).collect();
        expected.sort_unstable_by(|a, b| a.partial_cmp(b).unwrap());
        assert_eq!(sample, expected);
    }

    /// Of 2.1 million positions the first half comes twelve times. With 2^17 hashes held, at least 2^16 of them are left,
    /// half of which have copies: 11 times 2^15 more points, with a spread of 11 times the root of 2^15, 0.6 %.
    #[test]
    fn beyond_what_is_held_the_count_is_an_estimate() {
        let mut distinct = Distinct::holding(MOST_SAMPLED);
        let side = 128;
        for copy in 0..12 {
            let count = side * side * if copy == 0 { side } else { side / 2 };
            lattice(side).take(count as usize).for_each(|position| distinct.see(&position));
        }
        let (found, counted) = distinct.coincident();
        assert!(!counted);
        let expected = f64::from(11 * side.pow(3) / 2);
        assert!((found as f64 / expected - 1.0).abs() < 0.03, "{found}, not {expected}");
        assert!(!distinct.sample_is_whole());
        // Half of the sample is of the half that comes twelve times: 4 times the spread of half of 2^16.
        let sample = distinct.sample();
        assert!(
            (MOST_SAMPLED / 2 - 1024..=MOST_SAMPLED).contains(&sample.len()),
            "{}",
            sample.len()
        );
        let low = sample.iter().filter(|position| position[2] < f64::from(side / 2)).count();
        let share = low as f64 / sample.len() as f64;
        assert!((share - 0.5).abs() < 4.0 * 0.5 / 256.0, "{share}");
    }

    #[test]
    fn many_positions_without_copies_have_none() {
        let mut distinct = Distinct::holding(MOST_SAMPLED);
        lattice(100).for_each(|position| distinct.see(&position));
        assert_eq!(distinct.coincident(), (0, false));
    }
}
