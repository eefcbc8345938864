use super::*;
use points::Unwatched;

/// Of `pyproj.Proj("+proj=aeqd +lat_0=… +lon_0=… +ellps=WGS84")` 3.7, to its last micrometre.
#[test]
fn places_are_those_of_another_implementation() {
    for (center, place, expected) in [
        ([-86.495, 40.105], [-86.4963302, 40.1008713], [-113.423589, -458.436009]),
        ([-86.495, 40.105], [-86.6, 40.3], [-8927.008162, 21657.789167]),
        ([-86.495, 40.105], [-80.0, 45.0], [512227.844543, 563112.996705]),
        ([179.5, -17.3], [-179.9, -17.0], [63891.687069, 33102.341876]),
        ([179.5, -17.3], [179.9, -18.2], [42315.678625, -99654.478764]),
        ([0.0, 90.0], [10.0, 80.0], [193934.774905, -1099858.763108]),
        ([0.0, 90.0], [-170.0, 88.5], [-29093.116826, 164995.264533]),
        ([0.0, 90.0], [123.4, 66.0], [2236663.075003, 1474807.565579]),
        ([10.3, 60.1], [370.35, 60.05], [2785.7891, -5569.624493]),
        ([10.3, 60.1], [12.0, 58.0], [100537.481437, -232647.471231]),
        ([0.0, -90.0], [45.0, -70.0], [1578958.836879, 1578958.836879]),
    ] {
        let projection = MapProjection { center, stretch: 0.0 };
        let [x, y, z] = projection.apply(&Geodesic::wgs84(), [place[0], place[1], 12.5]);
        // Half of what is printed of it, and Karney's 15 nm.
        let near = (x - expected[0]).abs() < 6e-7 && (y - expected[1]).abs() < 6e-7;
        assert!(near && z == 12.5, "{center:?} {place:?}: {x} {y}, not {expected:?}");
    }
}

/// One degree of latitude at the equator is 110 574 m, one of longitude at 60° 55 800 m along the parallel
/// (55 799.47 m straight on), on WGS84.
#[test]
fn degrees_have_their_known_lengths() {
    let length = |center: [f64; 2], place: [f64; 2]| {
        let projection = MapProjection { center, stretch: 0.0 };
        let [x, y, _] = projection.apply(&Geodesic::wgs84(), [place[0], place[1], 0.0]);
        x.hypot(y)
    };
    assert!((length([7.0, 0.0], [7.0, 1.0]) - 110_574.388_6).abs() < 1e-3);
    assert!((length([7.0, 60.0], [8.0, 60.0]) - 55_799.470_4).abs() < 1e-3);
    assert_eq!(length([7.0, 60.0], [7.0, 60.0]), 0.0);
    assert_eq!(length([7.0, 90.0], [99.0, 90.0]), 0.0, "the pole has every longitude");
}

fn lattice(low: [f64; 2], high: [f64; 2]) -> Vec<[f64; 3]> {
    let at = |i: u32, axis: usize| low[axis] + (high[axis] - low[axis]) * f64::from(i) / 40.0;
    (0..41 * 41).map(|i| [at(i % 41, 0), at(i / 41, 1), 100.0]).collect()
}

fn center(places: &[&[[f64; 3]]]) -> [f64; 2] {
    MapProjection::of(places).unwrap().center
}

#[test]
fn the_center_is_the_round_middle_of_most_points() {
    let village = lattice([-86.50003, 40.1], [-86.49, 40.11]);
    assert_eq!(center(&[&village]), [-86.495, 40.105]);
    let mut strays = village.clone();
    // One in a hundred at the zero of a receiver without a fix.
    strays.iter_mut().step_by(100).for_each(|p| *p = [0.0; 3]);
    let [longitude, latitude] = center(&[&strays]);
    assert!((longitude + 86.495).abs() < 1e-3 && (latitude - 40.105).abs() < 1e-3, "{longitude}");
    let next = lattice([-86.49, 40.1], [-86.47, 40.11]);
    assert_eq!(center(&[&village, &next]), [-86.485, 40.105], "of all objects");
    assert_eq!(center(&[&[[7.123_456_789, 46.5, 0.0]]]), [7.123_456_789, 46.5], "one point");
    assert!(MapProjection::of(&[]).is_none() && MapProjection::of(&[&[]]).is_none());
}

#[test]
fn longitudes_are_counted_the_narrower_way() {
    let mut fiji = lattice([177.0, -19.0], [182.0, -16.0]);
    assert_eq!(center(&[&fiji]), [179.5, -17.5]);
    for p in fiji.iter_mut().filter(|p| p[0] > 180.0) {
        p[0] -= 360.0;
    }
    assert_eq!(center(&[&fiji]), [179.5, -17.5]);
    let east = lattice([178.0, -19.0], [179.0, -16.0]);
    let west = lattice([-179.0, -19.0], [-178.0, -16.0]);
    assert_eq!(center(&[&east, &west]), [-180.0, -17.5]);
    assert_eq!(center(&[&lattice([350.0, 51.0], [352.0, 52.0])]), [-9.0, 51.5]);
    assert_eq!(center(&[&lattice([-10.0, 40.0], [20.0, 60.0])]), [5.0, 50.0], "across Greenwich");
}

#[test]
fn a_cap_is_centered_on_its_pole_and_the_globe_on_zero() {
    assert_eq!(center(&[&lattice([-180.0, 66.0], [180.0, 90.0])]), [0.0, 90.0]);
    assert_eq!(center(&[&lattice([0.0, -90.0], [360.0, -60.0])]), [0.0, -90.0]);
    let globe = MapProjection::of(&[&lattice([-180.0, -90.0], [180.0, 90.0])]).unwrap();
    assert_eq!(globe.center, [0.0, 0.0]);
    assert!(globe.stretch > 1.0, "{}", globe.stretch);
}

/// Both sides of the antimeridian, and of a pole, are next to each other.
#[test]
fn nothing_is_torn() {
    for places in [
        lattice([179.0, -18.0], [181.0, -17.0]),
        lattice([-180.0, 80.0], [180.0, 90.0]),
        lattice([-10.0, 40.0], [20.0, 60.0]),
    ] {
        let projection = MapProjection::of(&[&places]).unwrap();
        let metres = projection.all(&places);
        let geodesic = Geodesic::wgs84();
        for row in 0..41 {
            for i in 0..40 {
                let (a, b) = (row * 41 + i, row * 41 + i + 1);
                let step = (metres[a][0] - metres[b][0]).hypot(metres[a][1] - metres[b][1]);
                let truth: f64 =
                    geodesic.inverse(places[a][1], places[a][0], places[b][1], places[b][0]);
                // The stretch is that of nineteen points of twenty, all are within twice that.
                let most = 1.0 + 2.0 * projection.stretch + 1e-9;
                assert!(
                    step < most * truth + 1e-6 && step > truth / most - 1e-6,
                    "{step} {truth} {projection:?}"
                );
            }
        }
    }
}

/// 1 + d²/6R² at 100 km: 4.1e-5.
#[test]
fn the_stretch_is_that_of_the_docs() {
    let country = MapProjection::of(&[&lattice([-1.0, 50.0], [1.0, 51.0])]).unwrap();
    assert!(country.stretch > 1e-5 && country.stretch < 4.1e-5, "{}", country.stretch);
}

fn scene_of(units: &[&str]) -> Scene {
    let objects: Vec<String> = units
        .iter()
        .map(|units| format!("[[objects]]\npoints = \"a.csv\"\nunits = \"{units}\"\n"))
        .collect();
    Scene::from_toml(&objects.concat(), "s.toml".as_ref(), &[]).expect("a scene")
}

fn set_of(positions: Vec<[f64; 3]>, units: Units) -> Arc<PointSet> {
    let file_index = (0..positions.len() as u32).collect();
    Arc::new(PointSet { positions, file_index, units, ..PointSet::default() })
}

#[test]
fn the_scene_has_the_last_word_on_units() {
    let says = Units::Degrees("it says so".to_owned());
    for (key, units, expected) in [
        ("auto", says.clone(), true),
        ("auto", Units::Lengths, false),
        ("auto", Units::LikeDegrees, false),
        ("degrees", Units::Lengths, true),
        ("scene", says.clone(), false),
    ] {
        let set = set_of(lattice([7.0, 46.0], [7.1, 46.1]), units);
        let (sets, projection) =
            projected(&scene_of(&[key]), &[Arc::clone(&set)], &Unwatched).unwrap();
        assert_eq!(projection.is_some(), expected, "{key}");
        assert_eq!(Arc::ptr_eq(&sets[0], &set), !expected, "{key}");
    }
    let set = set_of(lattice([7.0, 46.0], [7.1, 46.1]), says);
    let both = [Arc::clone(&set), set];
    let (sets, projection) = projected(&scene_of(&["auto", "auto"]), &both, &Unwatched).unwrap();
    assert!(Arc::ptr_eq(&sets[0], &sets[1]), "projected once");
    let text = projection.unwrap().to_string();
    assert_eq!(text, "+proj=aeqd +lat_0=46.05 +lon_0=7.05 +ellps=WGS84 +units=m");
}

#[test]
fn a_place_that_is_none_is_an_error_that_says_which() {
    let error = |positions: Vec<[f64; 3]>| {
        let set = set_of(positions, Units::Lengths);
        projected(&scene_of(&["degrees"]), &[set], &Unwatched).unwrap_err().to_string()
    };
    let mut stray = lattice([7.0, 46.0], [7.1, 46.1]);
    stray[5] = [7.0, -9999.0, 0.0];
    let message = error(stray);
    assert!(message.contains("point 5 of a.csv has longitude 7 and latitude -9999"), "{message}");
    assert!(message.contains("y = [-90, 90]"), "{message}");
    let message = error(lattice([46.0, 117.0], [46.1, 117.1]));
    assert!(message.contains("swapped"), "{message}");
    let message = error(lattice([5e5, 4.6e6], [5.1e5, 4.7e6]));
    assert!(message.contains("objects.0.units=scene"), "{message}");
}
