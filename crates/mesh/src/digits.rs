//! How exactly a text says its coordinates: by the digits that it has written.

/// Coordinates with fewer significant digits than this are what their author meant, such as 0.5; with more they are
/// rounded results of something.
const CHOSEN: i32 = 6;

/// The significant digits of the numbers of a text.
#[derive(Debug, Clone, Copy, Default)]
pub struct Digits {
    /// The most that a number has.
    most: i32,
    /// The largest exponent of the last place of these numbers: 10 to it is one unit there.
    last: i32,
}

impl Digits {
    /// Looks at a number as it is written: 12.5, -0.3e-4, 1d5.
    pub fn see(&mut self, word: &[u8]) {
        let end = word
            .iter()
            .position(|b| matches!(b, b'e' | b'E' | b'd' | b'D'));
        let (mantissa, exponent) = word.split_at(end.unwrap_or(word.len()));
        let exponent = match exponent {
            [_, digits @ ..] => {
                let text = std::str::from_utf8(digits).unwrap_or("");
                text.trim_start_matches('+').parse().unwrap_or(0)
            }
            [] => 0,
        };
        let (mut digits, mut behind, mut point) = (0, 0, false);
        for &b in mantissa {
            match b {
                b'.' => point = true,
                b'0'..=b'9' => {
                    behind += i32::from(point);
                    // Zeros in front count for nothing.
                    digits += i32::from(b != b'0' || digits > 0);
                }
                _ => {}
            }
        }
        let last = exponent - behind;
        if digits > self.most {
            *self = Digits { most: digits, last };
        } else if digits == self.most {
            self.last = self.last.max(last);
        }
    }

    /// One unit in the last place of the numbers with the most digits. Zero where the numbers are exact: they have few
    /// digits, or none were looked at.
    pub fn resolution(&self) -> f64 {
        match self.most {
            most if most < CHOSEN => 0.0,
            _ => 10f64.powi(self.last),
        }
    }
}

#[cfg(test)]
#[path = "../tests/digits.rs"]
mod tests;
