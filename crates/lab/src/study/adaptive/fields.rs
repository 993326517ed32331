//! Coefficient fields with large jumps, by cell of a regular grid: x fastest, the lowest row and layer first.

/// SplitMix64: random numbers that are the same everywhere.
struct Random(u64);

impl Random {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// In [0, 1).
    fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// In low..=high.
    fn between(&mut self, low: usize, high: usize) -> usize {
        low + (self.bits() % (high - low + 1) as u64) as usize
    }
}

/// A kind of field.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CoefficientField {
    /// One everywhere.
    Constant,
    /// 10^x with x uniform in [−p, p], one number for every subdomain.
    Subdomains(f64),
    /// 10^x with x uniform in [−p, p], one number for every element.
    Elements(f64),
    /// 10⁶ in straight channels along x, one element thick, through subdomains and bodies.
    Channels,
    /// 10⁶ in boxes of one to five elements at random positions.
    Inclusions,
}

/// The coefficient of channels and inclusions, in a matrix of 1.
pub const STIFF: f64 = 1e6;

/// Distance of channels in elements. It does not divide the number of elements of a body, so that channels cross
/// subdomains in different places.
const SPACING: usize = 5;

/// Inclusions take at least this part of the volume.
const FILLED: f64 = 0.2;

impl CoefficientField {
    /// Its name, a word.
    pub fn name(self) -> &'static str {
        match self {
            CoefficientField::Constant => "constant",
            CoefficientField::Subdomains(p) if p < 4.0 => "subdomain-3",
            CoefficientField::Subdomains(_) => "subdomain-6",
            CoefficientField::Elements(p) if p < 4.0 => "element-3",
            CoefficientField::Elements(_) => "element-6",
            CoefficientField::Channels => "channels",
            CoefficientField::Inclusions => "inclusions",
        }
    }

    /// A description.
    pub fn title(self) -> String {
        match self {
            CoefficientField::Constant => "constant coefficient".into(),
            CoefficientField::Subdomains(p) => format!("10^[-{p}, {p}] by subdomain"),
            CoefficientField::Elements(p) => format!("10^[-{p}, {p}] by element"),
            CoefficientField::Channels => "channels of 1e6, one element thick".into(),
            CoefficientField::Inclusions => "random inclusions of 1e6".into(),
        }
    }

    /// The cells of the grid, for these numbers of subdomains and elements of the whole domain in each direction.
    pub fn cells(self, subdomains: [usize; 3], elements: [usize; 3]) -> [usize; 3] {
        match self {
            CoefficientField::Constant => [1; 3],
            CoefficientField::Subdomains(_) => subdomains,
            _ => elements,
        }
    }

    /// The coefficient of every cell.
    pub fn values(self, cells: [usize; 3], seed: u64) -> Vec<f64> {
        let n: usize = cells.iter().product();
        let mut random = Random(seed);
        match self {
            CoefficientField::Constant => vec![1.0; n],
            CoefficientField::Subdomains(p) | CoefficientField::Elements(p) => (0..n)
                .map(|_| 10f64.powf(p * (2.0 * random.unit() - 1.0)))
                .collect(),
            CoefficientField::Channels => {
                let stiff = |i: usize| {
                    let (y, z) = (i / cells[0] % cells[1], i / cells[0] / cells[1]);
                    // In space channels are bars; plates would cut the domain.
                    y % SPACING == 2 && (cells[2] == 1 || z % 3 == 1)
                };
                (0..n).map(|i| if stiff(i) { STIFF } else { 1.0 }).collect()
            }
            CoefficientField::Inclusions => inclusions(cells, n, &mut random),
        }
    }
}

fn inclusions(cells: [usize; 3], n: usize, random: &mut Random) -> Vec<f64> {
    let mut values = vec![1.0; n];
    let mut filled = 0;
    while (filled as f64) < FILLED * n as f64 {
        let size = cells.map(|c| random.between(1, c.min(5)));
        let first: [usize; 3] = std::array::from_fn(|k| random.between(0, cells[k] - size[k]));
        for z in first[2]..first[2] + size[2] {
            for y in first[1]..first[1] + size[1] {
                let row = (z * cells[1] + y) * cells[0] + first[0];
                values[row..row + size[0]].fill(STIFF);
            }
        }
        filled = values.iter().filter(|v| **v > 1.0).count();
    }
    values
}

#[cfg(test)]
#[path = "../../../tests/study/adaptive/fields.rs"]
mod tests;
