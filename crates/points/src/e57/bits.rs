//! Numbers of any width, one after another, from the lowest bit on.

/// One number's bits of all points, so far as they were read and not yet taken.
pub(super) struct Stream {
    bytes: Vec<u8>,
    /// Bit where the next number begins.
    at: usize,
    /// Bits of a number, 0 to 64.
    width: u32,
}

impl Stream {
    pub(super) fn new(width: u32) -> Self {
        Self { bytes: Vec::new(), at: 0, width }
    }

    /// Room for so many bytes more.
    pub(super) fn room(&mut self, bytes: usize) -> &mut [u8] {
        let end = self.bytes.len();
        self.bytes.resize(end + bytes, 0);
        &mut self.bytes[end..]
    }

    /// How many whole numbers are there; any, where they have no bits.
    pub(super) fn values(&self) -> u64 {
        match self.width {
            0 => u64::MAX,
            width => ((8 * self.bytes.len() - self.at) / width as usize) as u64,
        }
    }

    /// The next number, which must be there.
    pub(super) fn next(&mut self) -> u64 {
        if self.width == 0 {
            return 0;
        }
        let first = self.at / 8;
        let mut word = [0; 16];
        let count = self.bytes.len().min(first + 9) - first;
        word[..count].copy_from_slice(&self.bytes[first..first + count]);
        let bits = (u128::from_le_bytes(word) >> (self.at % 8)) as u64;
        self.at += self.width as usize;
        bits & (u64::MAX >> (64 - self.width))
    }

    /// Lets go of what was taken.
    pub(super) fn forget(&mut self) {
        self.bytes.drain(..self.at / 8);
        self.at %= 8;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_any_width_come_out_as_they_went_in() {
        for width in 1..=64u32 {
            let mask = u64::MAX >> (64 - width);
            let numbers: Vec<u64> =
                (1..40u64).map(|i| i.wrapping_mul(0x9e37_79b9_7f4a_7c15) & mask).collect();
            let mut bits = Vec::new();
            for number in &numbers {
                bits.extend((0..width).map(|bit| number >> bit & 1 == 1));
            }
            let mut stream = Stream::new(width);
            let mut found = Vec::new();
            // Byte by byte, as packets may cut anywhere.
            for byte in bits.chunks(8) {
                let byte = (0..).zip(byte).map(|(i, &bit)| u8::from(bit) << i).sum();
                stream.room(1)[0] = byte;
                for _ in 0..stream.values() {
                    found.push(stream.next());
                }
                stream.forget();
                assert!(stream.bytes.len() <= 9);
            }
            assert_eq!(found[..39], numbers, "{width} bits");
        }
        assert_eq!((Stream::new(0).values(), Stream::new(0).next()), (u64::MAX, 0));
    }
}
