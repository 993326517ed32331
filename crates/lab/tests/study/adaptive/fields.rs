//! Unit tests of `crates/lab/src/study/adaptive/fields.rs`.

use super::*;

#[test]
fn fields_have_the_values_that_their_names_say() {
    let cells = [12, 10, 1];
    for p in [3.0, 6.0] {
        let values = CoefficientField::Elements(p).values(cells, 7);
        let logs: Vec<f64> = values.iter().map(|v| v.log10()).collect();
        assert!(logs.iter().all(|l| l.abs() <= p));
        assert!(logs.iter().any(|l| *l > 0.8 * p) && logs.iter().any(|l| *l < -0.8 * p));
        assert_eq!(values, CoefficientField::Elements(p).values(cells, 7));
    }
    let channels = CoefficientField::Channels.values(cells, 0);
    assert!(channels[24..36].iter().all(|v| *v == STIFF));
    assert_eq!(channels.iter().filter(|v| **v > 1.0).count(), 24);
    let stiff = |seed| {
        let values = CoefficientField::Inclusions.values(cells, seed);
        values.iter().filter(|v| **v == STIFF).count()
    };
    assert!((24..60).contains(&stiff(1)), "{}", stiff(1));
}
