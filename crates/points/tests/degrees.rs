//! Files whose x and y are longitude and latitude in degrees: by the names of their columns, by their
//! coordinate reference system, or only by the look of their numbers.

#![allow(clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use points::{PointSet, ReadOptions, Units, read_bytes};
use std::path::Path;

fn read(name: &str, bytes: &[u8]) -> PointSet {
    read_bytes(bytes, Path::new(name), &ReadOptions::default()).expect("a point file")
}

/// A hundred places about 86.5° W, 40.1° N, 250 m up.
fn places() -> Vec<[f64; 3]> {
    (0..100)
        .map(|i| {
            [
                -86.5 + 1e-4 * f64::from(i % 10),
                40.1 + 1e-4 * f64::from(i / 10),
                250.0 + f64::from(i % 7),
            ]
        })
        .collect()
}

fn table(header: &str) -> PointSet {
    let rows: Vec<String> =
        places().iter().map(|[x, y, z]| format!("{x:.7},{y:.7},{z:.2}\n")).collect();
    read("a.csv", format!("{header}\n{}", rows.concat()).as_bytes())
}

fn reason(set: &PointSet) -> &str {
    match &set.units {
        Units::Degrees(reason) => reason,
        other => panic!("{other:?}"),
    }
}

#[test]
fn columns_of_a_table_that_are_named_so_are_degrees() {
    for header in
        ["longitude,latitude,altitude", "Lon,Lat,Height", "LONGITUDE_CENTROID,LATITUDE_CENTROID,z"]
    {
        let set = table(header);
        let names: Vec<&str> = header.split(',').take(2).collect();
        assert_eq!(reason(&set), format!("its columns are named {} and {}", names[0], names[1]));
        assert_eq!(set.positions[0], [-86.5, 40.1, 250.0], "the numbers stay the file's");
        assert_eq!(set.notes, Vec::<String>::new());
    }
    // Heights have names of their own beside longitude and latitude.
    for z in ["ele", "GPSAltitude", "alt_m", "msl", "h_ph", "Ellipsoidal_Height"] {
        let set = table(&format!("lon_deg,lat_deg,{z}"));
        assert_eq!(set.positions[0], [-86.5, 40.1, 250.0], "{z}");
        assert_eq!(reason(&set), "its columns are named lon_deg and lat_deg");
    }
    // Latitude first: the names say which is which.
    let rows: Vec<String> = places().iter().map(|[x, y, z]| format!("{y} {x} {z}\n")).collect();
    let set = read("a.txt", format!("lat lon alt\n{}", rows.concat()).as_bytes());
    assert_eq!(
        (set.positions[0], reason(&set)),
        ([-86.5, 40.1, 250.0], "its columns are named lon and lat")
    );
}

/// What is beside longitude and latitude is not a height because it has the word in its name.
#[test]
fn how_exact_a_height_is_is_none() {
    let rows: Vec<String> = places().iter().map(|[x, y, z]| format!("{x},{y},0.5,{z}\n")).collect();
    let text = |names: &str| format!("{names}\n{}", rows.concat());
    let set = read("a.csv", text("lon_deg,lat_deg,alt_std,alt_m").as_bytes());
    assert_eq!(set.positions[0], [-86.5, 40.1, 250.0]);
    let bytes = text("lon,lat,height_agl,speed").into_bytes();
    let error = read_bytes(&bytes, Path::new("a.csv"), &ReadOptions::default());
    let error = error.expect_err("no z").to_string();
    assert!(error.contains("('lon', 'lat', 'height_agl', 'speed')"), "{error}");
}

#[test]
fn columns_that_only_hold_such_numbers_are_noticed_and_left() {
    assert_eq!(table("x,y,z").units, Units::LikeDegrees);
    assert_eq!(table("easting,northing,height").units, Units::LikeDegrees);
}

#[test]
fn names_that_the_numbers_contradict_are_not_believed() {
    let rows: Vec<String> = (0..50).map(|i| format!("{} 4600000 {i}\n", 500_000 + i)).collect();
    let set = read("a.txt", format!("lon lat alt\n{}", rows.concat()).as_bytes());
    assert_eq!(set.units, Units::Lengths);
    assert!(set.notes[0].contains("not taken as degrees"), "{:?}", set.notes);
}

#[test]
fn properties_of_ply_and_fields_of_numpy_records_are_named_so_too() {
    let rows: Vec<String> = places().iter().map(|[x, y, z]| format!("{x} {y} {z}\n")).collect();
    let header = "ply\nformat ascii 1.0\nelement vertex 100\nproperty double longitude\n\
                  property double latitude\nproperty double altitude\nend_header\n";
    let set = read("a.ply", format!("{header}{}", rows.concat()).as_bytes());
    assert_eq!(reason(&set), "its columns are named longitude and latitude");
    let mut header =
        "{'descr': [('lon', '<f8'), ('lat', '<f8'), ('alt', '<f8')], 'fortran_order': False, \
                      'shape': (100,), }"
            .to_owned();
    header.push_str(&" ".repeat(63 - (10 + header.len()) % 64));
    header.push('\n');
    let mut file = b"\x93NUMPY\x01\x00".to_vec();
    file.extend((header.len() as u16).to_le_bytes());
    file.extend(header.as_bytes());
    file.extend(places().iter().flatten().flat_map(|value| value.to_le_bytes()));
    assert_eq!(reason(&read("a.npy", &file)), "its columns are named lon and lat");
}

/// LAS 1.4, point format 6, with variable length records of (user, number, contents).
fn las(records: &[(&str, u16, &[u8])], places: &[[f64; 3]], well_known_text: bool) -> Vec<u8> {
    let mut vlrs = Vec::new();
    for (user, id, contents) in records {
        let mut head = [0; 54];
        head[2..2 + user.len()].copy_from_slice(user.as_bytes());
        head[18..20].copy_from_slice(&id.to_le_bytes());
        head[20..22].copy_from_slice(&(contents.len() as u16).to_le_bytes());
        vlrs.extend(head);
        vlrs.extend(*contents);
    }
    let mut file = vec![0; 375];
    let mut put = |at: usize, bytes: &[u8]| file[at..at + bytes.len()].copy_from_slice(bytes);
    put(0, b"LASF");
    put(6, &[if well_known_text { 1 << 4 } else { 0 }, 0, 0]);
    put(24, &[1, 4]);
    put(94, &375u16.to_le_bytes());
    put(96, &(375 + vlrs.len() as u32).to_le_bytes());
    put(100, &(records.len() as u32).to_le_bytes());
    put(104, &[6]);
    put(105, &30u16.to_le_bytes());
    for (axis, scale) in [1e-7f64, 1e-7, 1e-2].into_iter().enumerate() {
        put(131 + 8 * axis, &scale.to_le_bytes());
    }
    put(247, &(places.len() as u64).to_le_bytes());
    file.extend(vlrs);
    for place in places {
        let mut record = [0; 30];
        for (axis, steps) in
            [place[0] * 1e7, place[1] * 1e7, place[2] * 1e2].into_iter().enumerate()
        {
            record[4 * axis..4 * axis + 4].copy_from_slice(&(steps.round() as i32).to_le_bytes());
        }
        file.extend(record);
    }
    file
}

fn geo_keys(pairs: &[[u16; 2]]) -> Vec<u8> {
    let head = [1, 1, 0, pairs.len() as u16];
    let keys = pairs.iter().flat_map(|&[id, value]| [id, 0, 1, value]);
    head.into_iter().chain(keys).flat_map(u16::to_le_bytes).collect()
}

const USER: &str = "LASF_Projection";
const WGS84: &str = "GEOGCS[\"WGS 84\",DATUM[\"WGS_1984\",SPHEROID[\"WGS 84\",6378137,298.257223563]],\
                     PRIMEM[\"Greenwich\",0],UNIT[\"degree\",0.0174532925199433]]";

#[test]
fn a_geographic_system_of_las_makes_degrees() {
    let keys = geo_keys(&[[1024, 2], [2048, 4326], [2054, 9102]]);
    let set = read("a.las", &las(&[(USER, 34735, &keys)], &places(), false));
    assert_eq!(reason(&set), "its coordinate reference system is geographic (EPSG:4326)");
    let text = format!("{WGS84}\0");
    let set = read("a.las", &las(&[(USER, 2112, text.as_bytes())], &places(), true));
    assert_eq!(reason(&set), "its coordinate reference system is geographic (WGS 84)");
    assert_eq!(set.notes, Vec::<String>::new());
    assert!((set.positions[0][0] + 86.5).abs() < 1e-9, "{:?}", set.positions[0]);
}

#[test]
fn a_projected_system_of_las_makes_none_though_it_has_a_geographic_one_inside() {
    let metres: Vec<[f64; 3]> =
        (0..50).map(|i| [f64::from(i), 2.0 * f64::from(i % 7), 3.0]).collect();
    let text =
        format!("PROJCS[\"UTM\",{WGS84},PROJECTION[\"Transverse_Mercator\"],UNIT[\"metre\",1]]");
    let keys = geo_keys(&[[1024, 1], [2048, 4326], [3072, 32616]]);
    for (id, contents) in [(2112, text.as_bytes()), (34735, &keys)] {
        let set = read("a.las", &las(&[(USER, id, contents)], &metres, id == 2112));
        assert_eq!((set.units, set.notes), (Units::Lengths, vec![]));
    }
    assert_eq!(read("a.las", &las(&[], &metres, false)).units, Units::Lengths);
    // The bit of the header says which of two counts.
    let both: [(&str, u16, &[u8]); 2] =
        [(USER, 34735, &geo_keys(&[[1024, 2], [2048, 4326]])), (USER, 2112, text.as_bytes())];
    assert_eq!(read("a.las", &las(&both, &metres, true)).units, Units::Lengths);
    assert!(matches!(read("a.las", &las(&both, &metres, false)).units, Units::Degrees(_)));
}

#[test]
fn what_is_odd_about_a_geographic_system_is_said() {
    let grads = geo_keys(&[[1024, 2], [2048, 4807], [2054, 9105]]);
    let set = read("a.las", &las(&[(USER, 34735, &grads)], &places(), false));
    assert!(set.notes[0].contains("angles are not degrees"), "{:?}", set.notes);
    assert!(!matches!(set.units, Units::Degrees(_)));
    let feet = geo_keys(&[[1024, 2], [2048, 4269], [4099, 9003]]);
    let set = read("a.las", &las(&[(USER, 34735, &feet)], &places(), false));
    assert!(set.notes[0].contains("heights in US survey feet"), "{:?}", set.notes);
    assert!(matches!(set.units, Units::Degrees(_)));
    // Cut off records are no reason to refuse the points.
    let set = read(
        "a.las",
        &las(&[(USER, 34735, &[1, 0, 1]), (USER, 2112, b"GEOGCS[\"")], &places(), false),
    );
    assert_eq!(set.len(), 100);
}
