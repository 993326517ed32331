//! Axes: scales, ranges, and positions of ticks.

/// The map from numbers to positions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// Equal distances are equal differences.
    Linear,
    /// Equal distances are equal ratios; only numbers > 0 are shown.
    Log,
}

impl Scale {
    /// The position of a number on the scale, up to an affine map.
    pub fn forward(self, x: f64) -> f64 {
        match self {
            Scale::Linear => x,
            Scale::Log => x.log10(),
        }
    }

    /// Whether the number has a place on this scale.
    pub fn shows(self, x: f64) -> bool {
        x.is_finite() && (self == Scale::Linear || x > 0.0)
    }
}

/// A tick: its position and its label. Minor ticks have no label.
#[derive(Debug, Clone, PartialEq)]
pub struct Tick {
    /// The number.
    pub at: f64,
    /// Its text, empty for a minor tick.
    pub label: String,
}

/// The smallest range that contains the numbers with a margin; 0..1 (or 1..10) without any numbers.
pub fn range(values: impl Iterator<Item = f64>, scale: Scale) -> (f64, f64) {
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for v in values.filter(|&v| scale.shows(v)) {
        low = low.min(v);
        high = high.max(v);
    }
    match scale {
        _ if low > high && scale == Scale::Log => (1.0, 10.0),
        _ if low > high => (0.0, 1.0),
        Scale::Linear => {
            let size = high - low;
            let air = if size > 1e-12 * high.abs().max(low.abs()) {
                0.05 * size
            } else {
                high.abs().max(1.0) * 0.5
            };
            // A range that nearly starts at zero starts at zero.
            let from_zero = low >= 0.0 && low < 0.35 * high;
            (if from_zero { 0.0 } else { low - air }, high + air)
        }
        Scale::Log => {
            let air = if high > 1.0001 * low {
                (high / low).powf(0.05)
            } else {
                2.0
            };
            (low / air, high * air)
        }
    }
}

/// Ticks for a range: about `wanted` labelled ones.
pub fn ticks(low: f64, high: f64, scale: Scale, wanted: usize) -> Vec<Tick> {
    match scale {
        Scale::Linear => linear(low, high, wanted),
        Scale::Log => logarithmic(low, high, wanted),
    }
}

fn linear(low: f64, high: f64, wanted: usize) -> Vec<Tick> {
    let raw = (high - low) / wanted.max(1) as f64;
    if raw.is_nan() || raw <= 0.0 || !raw.is_finite() {
        return vec![Tick {
            at: low,
            label: number(low),
        }];
    }
    let power = 10f64.powf(raw.log10().floor());
    let step = power
        * [1.0, 2.0, 2.5, 5.0, 10.0]
            .into_iter()
            .find(|m| m * power >= raw * 0.999)
            .unwrap_or(10.0);
    let first = (low / step - 1e-9).ceil() as i64;
    let last = (high / step + 1e-9).floor() as i64;
    let size = low.abs().max(high.abs());
    let digits = (0..12).find(|&d| {
        let scaled = step * 10f64.powi(d);
        (scaled - scaled.round()).abs() < 1e-6 * scaled
    });
    (first..=last)
        .map(|k| {
            let at = k as f64 * step;
            let label = match digits {
                _ if k == 0 => "0".to_string(),
                Some(d) if size < 1e5 && d <= 5 => {
                    format!("{at:.0$}", d as usize).replace('-', "−")
                }
                _ => number(at),
            };
            Tick { at, label }
        })
        .collect()
}

fn logarithmic(low: f64, high: f64, wanted: usize) -> Vec<Tick> {
    let (first, last) = (low.log10().floor() as i32, high.log10().ceil() as i32);
    let decades = high.log10() - low.log10();
    // On few decades 1, 2 and 5 are labelled; on many decades some powers of ten at equal distances.
    let labelled: &[u32] = if decades < 1.0 {
        &[1, 2, 3, 5, 7]
    } else if decades < 2.5 {
        &[1, 2, 5]
    } else {
        &[1]
    };
    let every = (decades / wanted.max(1) as f64).ceil().max(1.0) as i32;
    // Either all labels are plain numbers or all are powers.
    let plain = low > 0.9e-3 && high < 1.1e4;
    let label = |m: u32, power: i32| {
        let exponent = power.to_string().replace('-', "−");
        match m {
            _ if plain => number(f64::from(m) * 10f64.powi(power)),
            1 => format!("10^{{{exponent}}}"),
            m => format!("{m}·10^{{{exponent}}}"),
        }
    };
    let mut out = Vec::new();
    for power in first..=last {
        for m in 1..10 {
            let at = f64::from(m) * 10f64.powi(power);
            if at < low * (1.0 - 1e-9) || at > high * (1.0 + 1e-9) {
                continue;
            }
            let wordy = labelled.contains(&m) && power.rem_euclid(every) == 0;
            if !wordy && decades > 6.0 {
                continue;
            }
            out.push(Tick {
                at,
                label: if wordy {
                    label(m, power)
                } else {
                    String::new()
                },
            });
        }
    }
    out
}

/// The label of a number: plain between 0.001 and 100000, else as 2·10⁷.
pub fn number(x: f64) -> String {
    if x == 0.0 {
        return "0".to_string();
    }
    if (1e-3..1e5).contains(&x.abs()) {
        let digits = (3 - x.abs().log10().floor() as i32).clamp(0, 6) as usize;
        let text = format!("{x:.digits$}");
        let text = if text.contains('.') {
            text.trim_end_matches('0').trim_end_matches('.')
        } else {
            &text
        };
        return text.replace('-', "−");
    }
    let text = format!("{x:.2e}");
    let (mantissa, power) = text.split_once('e').unwrap_or((&text, "0"));
    let mantissa = mantissa
        .trim_end_matches('0')
        .trim_end_matches('.')
        .replace('-', "−");
    let power = power.replace('-', "−");
    match mantissa.as_str() {
        "1" => format!("10^{{{power}}}"),
        "−1" => format!("−10^{{{power}}}"),
        m => format!("{m}·10^{{{power}}}"),
    }
}

#[cfg(test)]
#[path = "../../tests/drawing/ticks.rs"]
mod tests;
