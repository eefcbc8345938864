//! What an EXR says of where its picture comes from, beside the scene: enough to know whether two
//! pictures were made from the same, by the same. What a transfer function is stands in the scene itself.

use crate::engine::Engine;
use crate::input::Input;
use film::Provenance;
use kernels::layout::IMAGE_SRGB8;
use plan::Plan;
use points::{PointSet, Values};
use sha2::{Digest, Sha256};
use std::sync::Arc;

/// The plan's provenance with the program's version, the device and its driver, the seed, and hashes of
/// the scene, of each object's points, and of images. Nothing that changes from run to run on one machine.
pub fn of(plan: &Plan, input: &Input, sets: &[Arc<PointSet>], engine: &Engine) -> Provenance {
    let mut provenance = plan.provenance().clone();
    let scene = provenance.settings.iter().find(|(key, _)| key == "scene");
    let scene_hash = scene.map(|(_, text)| hex(Sha256::digest(text)));
    let mut add = |key: String, value: String| provenance.settings.push((key, value));
    add("version".to_owned(), env!("CARGO_PKG_VERSION").to_owned());
    add("seed".to_owned(), input.scene.render.seed.to_string());
    add("device".to_owned(), engine.name());
    if !engine.driver().is_empty() {
        add("driver".to_owned(), engine.driver());
    }
    if let Some(hash) = scene_hash {
        add("scene.sha256".to_owned(), hash);
    }
    let mut hashes: Vec<String> = Vec::new();
    for (index, (object, set)) in input.scene.objects.iter().zip(sets).enumerate() {
        if object.is_ground() {
            hashes.push(String::new());
            continue;
        }
        // A file that several objects use is hashed once.
        let known = sets[..index].iter().position(|earlier| Arc::ptr_eq(earlier, set));
        let hash = known.map_or_else(|| points_hash(set), |earlier| hashes[earlier].clone());
        // With the prefix at most 31 letters: files with longer names cannot be read by every program.
        add(format!("points.{index}.sha256"), hash.clone());
        hashes.push(hash);
    }
    // An image that is made of a sky or a gradient says nothing that the scene does not.
    let environment = input.scene.background.environment.is_some();
    if let (true, Some(hash)) = (environment, image_hash(plan, plan.wave.background.environment)) {
        add("environment.sha256".to_owned(), hash);
    }
    for (index, object) in plan.objects.iter().enumerate() {
        if let Some(hash) = image_hash(plan, object.texture) {
            add(format!("texture.{index}.sha256"), hash);
        }
    }
    provenance
}

/// SHA-256 of an image of the plan, whatever its file's encoding: columns and rows as u32; then its texels
/// row by row, in sRGB as the bytes R, G, B, 255, else as three f32. All little-endian.
fn image_hash(plan: &Plan, image: u32) -> Option<String> {
    let info = plan.images.get(image as usize)?;
    let words =
        info.width as usize * info.height as usize * if info.format == IMAGE_SRGB8 { 1 } else { 3 };
    let mut hash = Sha256::new();
    hash.update(info.width.to_le_bytes());
    hash.update(info.height.to_le_bytes());
    for word in &plan.texels[info.first as usize..][..words] {
        hash.update(word.to_le_bytes());
    }
    Some(hex(hash.finalize()))
}

/// SHA-256 of a point set as the picture uses it, whatever its file's encoding: the number of points as u64,
/// their positions as f64; then for colours, normals and each attribute that was read, in the file's order,
/// the name, a zero byte and the values, in the smallest float type that holds them. All little-endian.
fn points_hash(set: &PointSet) -> String {
    let mut hash = Sha256::new();
    hash.update((set.len() as u64).to_le_bytes());
    let mut bytes = Vec::new();
    let mut feed = |name: Option<&str>, values: &mut dyn Iterator<Item = Number>| {
        if let Some(name) = name {
            hash.update(name.as_bytes());
            hash.update([0]);
        }
        for value in values {
            match value {
                Number::Single(value) => bytes.extend(value.to_le_bytes()),
                Number::Double(value) => bytes.extend(value.to_le_bytes()),
            }
            if bytes.len() >= 1 << 16 {
                hash.update(&bytes);
                bytes.clear();
            }
        }
        hash.update(&bytes);
        bytes.clear();
    };
    feed(None, &mut set.positions.iter().flatten().map(|&v| Number::Double(v)));
    for (name, vectors) in [("colors", &set.colors), ("normals", &set.normals)] {
        if let Some(vectors) = vectors {
            feed(Some(name), &mut vectors.iter().flatten().map(|&v| Number::Single(v)));
        }
    }
    for attribute in &set.attributes {
        let single = match attribute.values {
            Values::I32(_) | Values::U32(_) | Values::F64(_) => false,
            Values::I8(_) | Values::U8(_) | Values::I16(_) | Values::U16(_) | Values::F32(_) => {
                true
            }
        };
        let number = |value: f64| match single {
            true => Number::Single(value as f32),
            false => Number::Double(value),
        };
        feed(Some(&attribute.name), &mut attribute.values.iter().map(number));
    }
    hex(hash.finalize())
}

enum Number {
    Single(f32),
    Double(f64),
}

fn hex(bytes: impl IntoIterator<Item = u8>) -> String {
    bytes.into_iter().map(|byte| format!("{byte:02x}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use points::Attribute;

    fn set() -> PointSet {
        PointSet {
            positions: vec![[1.0, 2.0, 3.0], [0.5, -0.25, 1e300]],
            colors: Some(vec![[0.5; 3]; 2]),
            attributes: vec![
                Attribute { name: "a".to_owned(), values: Values::F32(vec![1.0, 2.0]) },
                Attribute { name: "b".to_owned(), values: Values::F64(vec![3.0, 4.0]) },
            ],
            ..PointSet::default()
        }
    }

    /// SHA-256 of `struct.pack('<Qddd', 1, 1.0, 2.0, 3.0)`, by Python's hashlib.
    #[test]
    fn the_hash_of_a_bare_point_is_that_of_its_bytes() {
        let one = PointSet { positions: vec![[1.0, 2.0, 3.0]], ..PointSet::default() };
        assert_eq!(
            points_hash(&one),
            "4db8a5a59452baf6b79006bf96cfaac4db239c4273b4fca79e0453035c0ef98f"
        );
    }

    #[test]
    fn every_number_and_name_changes_the_hash_and_the_format_does_not() {
        let hash = points_hash(&set());
        assert_eq!(hash, points_hash(&PointSet { format: "PLY".to_owned(), ..set() }));
        let changes: [fn(&mut PointSet); 6] = [
            |set| set.positions[1][2] = 1e301,
            |set| set.positions.swap(0, 1),
            |set| set.colors = None,
            |set| set.normals = Some(vec![[0.0; 3]; 2]),
            |set| set.attributes[0].name = "c".to_owned(),
            |set| set.attributes[1].values = Values::F32(vec![3.0, 4.0]),
        ];
        for (index, change) in changes.into_iter().enumerate() {
            let mut changed = set();
            change(&mut changed);
            assert_ne!(hash, points_hash(&changed), "change {index}");
        }
    }
}
