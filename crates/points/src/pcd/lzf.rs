//! LZF, the compression of Marc Lehmann's liblzf: runs of literal bytes, and references back.

/// Bytes that one byte may become at most.
pub(super) const MOST: u64 = 88;

/// The bytes that `packed` stands for, exactly `length` of them; `None` where they are others.
pub(super) fn decompress(packed: &[u8], length: usize) -> Option<Vec<u8>> {
    let mut out = Vec::new();
    out.try_reserve_exact(length).ok()?;
    let mut at = 0;
    while let Some(&control) = packed.get(at) {
        let control = usize::from(control);
        at += 1;
        if control < 32 {
            // Literal bytes, one more than the number says.
            let run = packed.get(at..at + control + 1)?;
            at += run.len();
            if out.len() + run.len() > length {
                return None;
            }
            out.extend_from_slice(run);
            continue;
        }
        let mut count = (control >> 5) + 2;
        if count == 9 {
            count += usize::from(*packed.get(at)?);
            at += 1;
        }
        let back = (control & 31) << 8 | usize::from(*packed.get(at)?);
        at += 1;
        let from = out.len().checked_sub(back + 1)?;
        if out.len() + count > length {
            return None;
        }
        // What is copied may reach into what is being written.
        for place in from..from + count {
            out.push(out[place]);
        }
    }
    (out.len() == length).then_some(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_and_references_are_put_together() {
        // Four literals; three bytes from four back; nine and ten more from one back.
        let packed = [3, b'a', b'b', b'c', b'd', 1 << 5, 3, 7 << 5, 10, 0];
        let whole = b"abcdabccccccccccccccccccccc";
        assert_eq!(decompress(&packed, 4 + 3 + 19).as_deref(), Some(&whole[..26]));
        for length in 0..packed.len() {
            assert_eq!(decompress(&packed[..length], 26), None);
        }
        assert_eq!(decompress(&packed, 25), None);
        assert_eq!(decompress(&[1 << 5, 0], 3), None);
        assert_eq!(decompress(&[], 0), Some(Vec::new()));
    }
}
