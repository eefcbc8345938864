use super::*;
use kernels::layout::IMAGE_LINEAR;

/// A linear image whose grey values are these, the top row first.
fn grey(width: u32, height: u32, value: impl Fn(u32, u32) -> f32) -> (ImageInfo, Vec<u32>) {
    let texel = |at: u32| [value(at % width, at / width).to_bits(); 3];
    let texels = (0..width * height).flat_map(texel).collect();
    (ImageInfo { first: 0, width, height, format: IMAGE_LINEAR }, texels)
}

fn table(width: u32, height: u32, value: impl Fn(u32, u32) -> f32) -> Option<EnvironmentTable> {
    let (image, texels) = grey(width, height, value);
    EnvironmentTable::of(&image, &texels)
}

/// The parts of a table's values as its documentation has them.
struct Parts<'a> {
    cosines: &'a [f32],
    marginal: &'a [f32],
    conditional: &'a [f32],
    densities: &'a [f32],
}

fn parts(table: &EnvironmentTable) -> Parts<'_> {
    let (columns, rows) = (table.columns as usize, table.rows as usize);
    assert_eq!(table.values[0].to_bits(), table.columns);
    assert_eq!(table.values[1].to_bits(), table.rows);
    let (cosines, rest) = table.values[2..].split_at(rows + 1);
    let (marginal, rest) = rest.split_at(rows);
    let (conditional, densities) = rest.split_at(rows * columns);
    assert_eq!(densities.len(), rows * columns);
    Parts { cosines, marginal, conditional, densities }
}

/// The steradians of a cell of a row.
fn cell_angle(table: &EnvironmentTable, row: usize) -> f64 {
    let cosines = parts(table).cosines;
    TAU / f64::from(table.columns) * (f64::from(cosines[row]) - f64::from(cosines[row + 1]))
}

fn integral(table: &EnvironmentTable) -> f64 {
    let columns = table.columns as usize;
    let cells = parts(table).densities.iter().enumerate();
    cells.map(|(at, &density)| f64::from(density) * cell_angle(table, at / columns)).sum()
}

/// Of each density f32 keeps 6e-8, of their sum less.
#[test]
fn densities_integrate_to_one_and_distributions_end_there() {
    let ragged = |column: u32, row: u32| ((column * 7919 + row * 104_729) % 1000) as f32 - 300.0;
    for (width, height) in [(1, 1), (1, 9), (7, 1), (64, 32), (513, 257), (1030, 700)] {
        let table = table(width, height, |column, row| ragged(column, row).max(0.0) + 1e-3);
        let table = table.expect("it is not black");
        assert_eq!([table.columns, table.rows], [width.min(512), height.min(256)]);
        assert!((integral(&table) - 1.0).abs() < 1e-6, "{width} x {height}");
        let parts = parts(&table);
        let [first, .., last] = parts.cosines else { panic!("two borders or more") };
        assert_eq!([*first, *last], [1.0, -1.0]);
        for distribution in
            parts.conditional.chunks(width.min(512) as usize).chain([parts.marginal])
        {
            assert!(distribution.is_sorted());
            assert_eq!(distribution.last(), Some(&1.0));
        }
    }
}

/// What is drawn in a cell is its density times its solid angle: equal to f32's rounding of the density.
#[test]
fn densities_are_those_of_the_distributions_as_they_are_rounded() {
    let table = table(40, 20, |column, row| (column * row) as f32).expect("it is not black");
    let parts = parts(&table);
    let before = |list: &[f32], at: usize| if at == 0 { 0.0 } else { f64::from(list[at - 1]) };
    for row in 0..20 {
        let of_row = &parts.conditional[40 * row..][..40];
        let share_of_row = f64::from(parts.marginal[row]) - before(parts.marginal, row);
        for column in 0..40 {
            let share = share_of_row * (f64::from(of_row[column]) - before(of_row, column));
            let density = (share / cell_angle(&table, row)) as f32;
            assert_eq!(parts.densities[40 * row + column], density);
        }
    }
}

#[test]
fn a_black_image_has_no_table() {
    assert_eq!(table(16, 8, |_, _| 0.0), None);
}

/// 1 / 4 pi everywhere, to 1e-3 at the pole, where a row of 256 has 7.5e-5 of the sphere: the marginal distribution is
/// rounded to 6e-8 of the whole, and the cosine of the first border to as much. The mean is exact but for f32's cosines.
#[test]
fn an_even_image_is_drawn_evenly() {
    let table = table(1024, 512, |_, _| 2.5).expect("it is not black");
    for &density in parts(&table).densities {
        assert!((f64::from(density) * 4.0 * PI - 1.0).abs() < 1.5e-3, "{density}");
    }
    assert!((table.mean - 2.5).abs() < 1e-6 && (table.peak_over_mean - 1.0).abs() < 1e-6);
}

/// A cell of one texel sees 6/8 of it along each axis and 1/8 of its neighbours, over the seam too, and the outer rows
/// see themselves instead of a row beyond the edge.
#[test]
fn densities_follow_a_texel_and_what_is_blended_of_it() {
    for (bright, rows) in [
        ([5, 3], vec![(2, 0.125), (3, 0.75), (4, 0.125)]),
        ([0, 0], vec![(0, 0.875), (1, 0.125)]),
        ([15, 7], vec![(6, 0.125), (7, 0.875)]),
    ] {
        let table = table(16, 8, |column, row| if [column, row] == bright { 8.0 } else { 0.0 });
        let table = table.expect("it is not black");
        let densities = parts(&table).densities;
        let column = bright[0] as usize;
        let columns = [((column + 15) % 16, 0.125), (column, 0.75), ((column + 1) % 16, 0.125)];
        let lit = |list: &[(usize, f64)], at| {
            list.iter().find(|(place, _)| *place == at).map_or(0.0, |(_, share)| *share)
        };
        let flux: f64 =
            rows.iter().map(|&(row, share)| 8.0 * share * cell_angle(&table, row)).sum();
        // Within 1e-6: three roundings of f32 to at most 6e-8, of shares of 1/8 and more.
        for (at, &density) in densities.iter().enumerate() {
            let brightness = 8.0 * lit(&columns, at % 16) * lit(&rows, at / 16);
            let expected = brightness / flux;
            assert!((f64::from(density) - expected).abs() <= 1e-6 * expected.max(1.0), "{at}");
        }
        assert!((table.mean - flux / (4.0 * PI)).abs() < 1e-6 * table.mean);
    }
}

/// The mean over a cell of 2.5 by 1.5 texels is that of many lookups, within what 200 x 200 midpoints of a piecewise
/// linear function leave: kinks, each at most a step of 1/200 squared.
#[test]
fn cells_of_several_texels_have_their_exact_mean() {
    let (image, texels) = grey(1280, 384, |column, row| ((column * 31 + row * 17) % 23) as f32);
    let means = mean_luminances(&image, &texels, [512, 256]);
    let at = |column: i64, row: i64| {
        let place = row.clamp(0, 383) * 1280 + column.rem_euclid(1280);
        f64::from(f32::from_bits(texels[3 * place as usize]))
    };
    let looked_up = |x: f64, y: f64| {
        let (x, y) = (x - 0.5, y - 0.5);
        let (column, row) = (x.floor() as i64, y.floor() as i64);
        let (across, down) = (x - x.floor(), y - y.floor());
        let of_row = |row| at(column, row) * (1.0 - across) + at(column + 1, row) * across;
        of_row(row) * (1.0 - down) + of_row(row + 1) * down
    };
    for (column, row) in [(0, 0), (511, 100), (17, 255), (300, 128)] {
        let mut sum = 0.0;
        for i in 0..200 {
            for j in 0..200 {
                let [x, y] = [i, j].map(|k| (f64::from(k) + 0.5) / 200.0);
                sum += looked_up((f64::from(column) + x) * 2.5, (f64::from(row) + y) * 1.5);
            }
        }
        let mean = means[row as usize * 512 + column as usize];
        assert!((mean - sum / 40_000.0).abs() < 2e-3, "{column}, {row}: {mean}");
    }
}

/// sRGB bytes through the table at the front of the texels: luminance of (255, 0, 51) is 0.2126 + 0.0722 * 0.0331.
#[test]
fn bytes_of_srgb_are_decoded() {
    let mut texels: Vec<u32> = (0..=255)
        .map(|byte| (film::linear_from_srgb(f64::from(byte) / 255.0) as f32).to_bits())
        .collect();
    texels.push(u32::from_le_bytes([255, 0, 51, 255]));
    let image = ImageInfo { first: 256, width: 1, height: 1, format: IMAGE_SRGB8 };
    let table = EnvironmentTable::of(&image, &texels).expect("it is not black");
    assert!((table.mean - (0.2126 + 0.0722 * 0.033_104_8)).abs() < 1e-6, "{}", table.mean);
}
