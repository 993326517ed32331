use super::*;

/// The tables that CalculiX 2.20 prints for `block.inp` (`ccx block`).
const BLOCK: &str = include_str!("block.dat");

#[test]
fn tables_of_calculix_are_read_and_written_byte_for_byte() {
    let tables = read_dat(BLOCK);
    let sizes: Vec<(DatQuantity, usize)> =
        tables.iter().map(|t| (t.quantity, t.rows.len())).collect();
    use DatQuantity::{Displacement, Force, TotalForce};
    let two = [
        (Displacement, 10),
        (Force, 10),
        (TotalForce, 1),
        (Displacement, 2),
    ];
    assert_eq!(sizes, [&two[..], &two[..], &[(TotalForce, 1)]].concat());
    assert_eq!((tables[4].set.as_str(), tables[4].time), ("REV", 2.5));
    let row = TableRow {
        id: 7,
        vector: [3.963262e-3, -7.126289e-3, -2.027991e-3],
        local: true,
    };
    assert_eq!(tables[0].rows[1], row);
    assert_eq!(write_dat(&tables), BLOCK);
}

/// The displacements of CalculiX at all nodes are what its tables are of: systems of nodes, order, sums, times.
#[test]
fn tables_of_a_deck_are_those_of_calculix() {
    let deck = include_bytes!("block.inp");
    let deck = crate::read("block.inp", deck, &|_| unreachable!()).expect("a deck");
    let printed = read_dat(BLOCK);
    let mut seen = 0;
    for step in 0..deck.steps.len() {
        let time = deck.steps[step].time;
        let at_time: Vec<&DatTable> = printed.iter().filter(|t| t.time == time).collect();
        // From the tables of all nodes back to the global system.
        let global = |quantity| {
            let mut all = vec![[0.0; 3]; deck.mesh.points.len()];
            for row in at_time
                .iter()
                .filter(|t| t.quantity == quantity)
                .flat_map(|t| &t.rows)
            {
                let node = row.id as usize - 1;
                let frame = deck.frame(node as u32).filter(|_| row.local);
                all[node] = frame.map_or(row.vector, |f| {
                    [0, 1, 2].map(|d| (0..3).map(|i| f[i][d] * row.vector[i]).sum())
                });
            }
            all
        };
        let tables = deck.tables(
            step,
            &global(DatQuantity::Displacement),
            &global(DatQuantity::Force),
        );
        for table in tables.iter().flatten() {
            let same = at_time
                .iter()
                .find(|t| t.quantity == table.quantity && t.set == table.set);
            let same = same.expect("a table of CalculiX");
            assert_eq!(table.rows.len(), same.rows.len());
            if table.quantity == DatQuantity::TotalForce && step == 2 {
                continue; // The third step prints no forces of single nodes.
            }
            for (ours, theirs) in table.rows.iter().zip(&same.rows) {
                assert_eq!((ours.id, ours.local), (theirs.id, theirs.local));
                for (a, b) in ours.vector.iter().zip(theirs.vector) {
                    assert!((a - b).abs() < 2e-5, "{ours:?} {theirs:?}");
                }
                seen += 1;
            }
        }
    }
    assert_eq!(seen, 2 * 23);
}

#[test]
fn numbers_as_calculix_prints_them() {
    for (x, text) in [
        (0.0, "0.000000E+00"),
        (-0.0, "-0.000000E+00"),
        (1.0, "1.000000E+00"),
        (-123.4567891, "-1.234568E+02"),
        (9.9999999e-5, "1.000000E-04"),
        (1.5e-120, "1.500000-120"),
        (2.5e200, "2.500000+200"),
    ] {
        assert_eq!(scientific(x, 6, false), text);
        assert_eq!(
            fortran(text).map(|y| (y - x).abs() <= 1e-6 * x.abs()),
            Some(true)
        );
    }
    for (x, text) in [
        (0.0, "0.0000000E+00"),
        (1.0, "0.1000000E+01"),
        (0.999999999, "0.1000000E+01"),
        (250.0, "0.2500000E+03"),
    ] {
        assert_eq!(scientific(x, 7, true), text);
    }
    assert_eq!(scientific(f64::NAN, 6, false), "NaN");
}

#[test]
fn other_tables_are_passed_over() {
    let text = "\n stresses (elem, integ.pnt.,sxx,syy,szz,sxy,sxz,syz) for set EALL and time  0.1000000E+01\n\n\
                1 1 1.0 2.0 3.0 4.0 5.0 6.0\n\
                \n displacements (vx,vy,vz) for set N and time  0.1000000E+01\n\n 1 1.0 2.0 3.0\n\
                \n temperatures for set N and time  0.1000000E+01\n\n 1 5.0\n";
    let tables = read_dat(text);
    assert_eq!(tables.len(), 1);
    assert_eq!(tables[0].rows.len(), 1);
    assert!(read_dat("displacements (vx,vy,vz) for set and time").is_empty());
}
