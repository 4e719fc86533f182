//! Meshes from files: what is read, and that nothing in them brings the program down.

mod common;

use common::{is_closed, load_in, load_mesh, models, text_with, volume};
use proptest::prelude::*;

const CUBE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n\
    f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf -7 -6 -2 -3\nf 3 4 8 7\nf 4 1 5 8\n";

#[test]
fn quads_triangles_and_polygons_make_the_same_solid() {
    let cube = load_mesh("cube.obj", CUBE.as_bytes()).unwrap();
    assert_eq!(cube.mesh.triangles.len(), 12);
    // An L-shaped prism, whose hexagons a fan would fill wrongly.
    let prism = "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nv 0 0 1\nv 2 0 1\nv 2 1 1\nv 1 1 1\nv 1 2 1\nv 0 2 1\n\
        f 3 2 1 6 5 4\nf 9 10 11 12 7 8\nf 1 2 8 7\nf 2 3 9 8\nf 3 4 10 9\nf 4 5 11 10\nf 5 6 12 11\nf 6 1 7\nf 6 7 12\n";
    let prism = load_mesh("prism.obj", prism.as_bytes()).unwrap();
    for (scene, inside) in [(cube, 1.0), (prism, 3.0)] {
        scene.check().unwrap();
        assert!(is_closed(&scene));
        assert!((volume(&scene) - inside).abs() < 1e-6);
    }
}

#[test]
fn the_axis_that_points_up_becomes_z() {
    let tall = CUBE.replace("1 0\n", "5 0\n").replace("1 1\n", "5 1\n");
    let scene = load_mesh("tall.obj", tall.as_bytes()).unwrap();
    let (low, high) = scene.bounds().unwrap();
    assert_eq!((high - low).to_array(), [1.0, 1.0, 5.0]);
    assert!(volume(&scene) > 0.0, "turned, not mirrored");
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("tall.obj"), tall).unwrap();
    let text = text_with("Mesh(file: \"tall.obj\", up: Z)", "");
    let (low, high) = load_in(Some(folder.path()), &text, &[])
        .unwrap()
        .bounds()
        .unwrap();
    assert_eq!((high - low).to_array(), [1.0, 5.0, 1.0]);
}

#[test]
fn missing_normals_are_smooth_or_flat_as_asked_and_given_ones_are_kept() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("cube.obj"), CUBE).unwrap();
    let slanted = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 3 4\nvn 0 0 0\nf 1//1 2//1 3//2\n";
    std::fs::write(folder.path().join("slanted.obj"), slanted).unwrap();
    let load = |shape: &str| load_in(Some(folder.path()), &text_with(shape, ""), &[]).unwrap();
    let smooth = load("Mesh(file: \"cube.obj\")");
    for (position, normal) in smooth.mesh.positions.iter().zip(&smooth.mesh.normals) {
        let corner = (*position - glam::Vec3::new(0.5, -0.5, 0.5)).normalize();
        assert!((corner - *normal).length() < 1e-5, "{position}: {normal}");
    }
    let flat = load("Mesh(file: \"cube.obj\", normals: Flat)");
    assert_eq!(flat.mesh.positions.len(), 36);
    assert!(
        flat.mesh
            .normals
            .iter()
            .all(|n| (n.abs().max_element() - 1.0).abs() < 1e-6)
    );
    // y up in the file: (0, 3, 4) points along (0, −4, 3).
    let given = load("Mesh(file: \"slanted.obj\", normals: File)");
    let normals: Vec<_> = given.mesh.normals.iter().map(|n| n.to_array()).collect();
    assert!(normals.contains(&[0.0, -0.8, 0.6]), "{normals:?}");
    assert!(
        normals.contains(&[0.0, -1.0, 0.0]),
        "a zero is computed: {normals:?}"
    );
}

#[test]
fn degenerate_triangles_are_left_out() {
    let scene = load_mesh(
        "cube.obj",
        format!("{CUBE}f 1 1 2\nf 1 2 2\nv 2 0 0\nf 1 2 9\n").as_bytes(),
    )
    .unwrap();
    assert_eq!(scene.mesh.triangles.len(), 12);
    scene.check().unwrap();
}

/// A tetrahedron as glTF: JSON and its buffer. `indices` are of 16 bits.
fn tetrahedron(uri: &str, indices: [u16; 12]) -> (String, Vec<u8>) {
    let positions: [[f32; 3]; 4] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let mut buffer: Vec<u8> = positions
        .iter()
        .flatten()
        .flat_map(|x| x.to_le_bytes())
        .collect();
    buffer.extend(indices.iter().flat_map(|i| i.to_le_bytes()));
    let json = format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],
        "nodes":[{{"children":[1],"scale":[2,1,1]}},{{"mesh":0,"scale":[1,1,-1]}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1}}]}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[1,1,1]}},
        {{"bufferView":1,"componentType":5123,"count":12,"type":"SCALAR"}}],
        "bufferViews":[{{"buffer":0,"byteLength":48}},{{"buffer":0,"byteOffset":48,"byteLength":24}}],
        "buffers":[{{{uri}"byteLength":72}}]}}"#
    );
    (json, buffer)
}

const FACES: [u16; 12] = [0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3];

/// The binary form of a glTF file.
fn binary((mut json, buffer): (String, Vec<u8>)) -> Vec<u8> {
    while json.len() % 4 != 0 {
        json.push(' ');
    }
    let mut bytes = b"glTF".to_vec();
    let mut put = |number: usize| bytes.extend((number as u32).to_le_bytes());
    put(2);
    put(28 + json.len() + buffer.len());
    put(json.len());
    bytes.extend(b"JSON");
    bytes.extend(json.as_bytes());
    bytes.extend((buffer.len() as u32).to_le_bytes());
    bytes.extend(b"BIN\0");
    bytes.extend(buffer);
    bytes
}

#[test]
fn gltf_is_read_from_files_beside_it_from_within_and_in_its_binary_form() {
    let folder = tempfile::tempdir().unwrap();
    let (json, buffer) = tetrahedron(r#""uri":"my%20data.bin","#, FACES);
    std::fs::write(folder.path().join("beside.gltf"), json).unwrap();
    std::fs::write(folder.path().join("my data.bin"), &buffer).unwrap();
    let encoded = base64::Engine::encode(&base64::engine::general_purpose::STANDARD, &buffer);
    let uri = format!(r#""uri":"data:application/octet-stream;base64,{encoded}","#);
    std::fs::write(
        folder.path().join("within.gltf"),
        tetrahedron(&uri, FACES).0,
    )
    .unwrap();
    std::fs::write(
        folder.path().join("binary.glb"),
        binary(tetrahedron("", FACES)),
    )
    .unwrap();
    for file in ["beside.gltf", "within.gltf", "binary.glb"] {
        let text = text_with(&format!("Mesh(file: \"{file}\")"), "");
        let scene = load_in(Some(folder.path()), &text, &[]).unwrap();
        scene.check().unwrap();
        assert!(is_closed(&scene));
        // Twice the width, and mirrored without being turned inside out.
        assert!(
            (volume(&scene) - 2.0 / 6.0).abs() < 1e-6,
            "{file}: {}",
            volume(&scene)
        );
        assert_eq!(scene.bounds().unwrap().1.x, 2.0);
    }
}

#[test]
fn malformed_gltf_is_refused_with_a_reason() {
    let message = |file: &str, bytes: &[u8]| match load_mesh(file, bytes) {
        Ok(_) => panic!("accepted {file}"),
        Err(report) => report.to_string(),
    };
    let good = || tetrahedron("", FACES);
    let changed = |from: &str, to: &str| {
        let (json, buffer) = good();
        assert!(json.contains(from), "{from}");
        binary((json.replace(from, to), buffer))
    };
    let mut wrong_index = FACES;
    wrong_index[5] = 4;
    let mut not_finite = good();
    not_finite.1[12..16].copy_from_slice(&f32::NAN.to_le_bytes());
    let truncated = {
        let mut bytes = binary(good());
        bytes.truncate(100);
        bytes
    };
    for (bytes, words) in [
        (
            binary(tetrahedron("", wrong_index)),
            &["index 4 is out of range", "4 positions"][..],
        ),
        (binary(not_finite), &["not finite"]),
        (truncated, &["not a sound glTF file"]),
        (
            b"glTF\x02\0\0\0\0\0\0\0".to_vec(),
            &["not a sound glTF file"],
        ),
        (
            changed("\"byteOffset\":48", "\"byteOffset\":480"),
            &["beyond its buffer"],
        ),
        (
            changed("\"count\":12", "\"count\":1200"),
            &["beyond its buffer"],
        ),
        (
            changed("\"count\":4,", "\"count\":18446744073709551615,"),
            &["thing.glb"],
        ),
        (
            changed("\"byteLength\":48", "\"byteLength\":48,\"byteStride\":4"),
            &["beyond its buffer"],
        ),
        (
            changed("\"mesh\":0", "\"mesh\":7"),
            &["not a sound glTF file"],
        ),
        (
            changed("\"children\":[1]", "\"children\":[1, 0]"),
            &["twice"],
        ),
        (changed("\"POSITION\":0", "\"NORMAL\":0"), &["thing.glb"]),
        (
            changed("\"scale\":[1,1,-1]", "\"scale\":[1,1e30,1e38]"),
            &["further than"],
        ),
        (
            changed("\"POSITION\":0", "\"POSITION\":2"),
            &["accessor 2", "there are 2"],
        ),
    ] {
        let message = message("thing.glb", &bytes);
        for word in words.iter().chain(&["thing.glb"]) {
            assert!(message.contains(word), "`{word}` is missing in\n{message}");
        }
    }
    let outside = tetrahedron(r#""uri":"gone.bin","#, FACES).0;
    assert!(message("thing.gltf", outside.as_bytes()).contains("gone.bin"));
    let broken = tetrahedron(r#""uri":"data:;base64,@@@","#, FACES).0;
    assert!(message("thing.gltf", broken.as_bytes()).contains("base64"));
    assert!(message("thing.gltf", b"{").contains("not a sound glTF file"));
}

#[test]
fn real_meshes_load() {
    let Some(folder) = models() else {
        println!("skipped: there are no models beside the checkout");
        return;
    };
    for (file, triangles) in [
        ("spot.obj", 5856),
        ("teapot.obj", 6320),
        ("stanford-bunny.obj", 69451),
    ] {
        let text = text_with(&format!("Mesh(file: \"{file}\")"), "");
        let scene = load_in(Some(&folder), &text, &[]).unwrap();
        scene.check().unwrap();
        let count = scene.mesh.triangles.len();
        assert!(
            count <= triangles && count > triangles - triangles / 20,
            "{file}: {count}"
        );
        // Faces turn outwards, and normals stand on their side nearly everywhere.
        assert!(volume(&scene) > 0.0, "{file}");
        let mut outwards = 0;
        for (index, triangle) in scene.mesh.triangles.iter().enumerate() {
            let [a, b, c] = scene.mesh.corners(index);
            let normal = scene.mesh.normals[triangle.corners[0] as usize].as_dvec3();
            outwards += usize::from((b - a).cross(c - a).dot(normal) > 0.0);
        }
        assert!(
            outwards as f64 > 0.98 * count as f64,
            "{file}: {outwards} of {count}"
        );
    }
}

/// Words that OBJ files are made of, and some that they should not be.
fn obj_word() -> impl Strategy<Value = String> {
    prop_oneof![
        Just("\n".to_owned()),
        Just("\nv".to_owned()),
        Just("\nvn".to_owned()),
        Just("\nvt".to_owned()),
        Just("\nf".to_owned()),
        Just("\ng a\nusemtl b".to_owned()),
        (-9_i32..9).prop_map(|i| i.to_string()),
        (-4_i32..5, -4_i32..5).prop_map(|(a, b)| format!("{a}//{b}")),
        (-4_i32..5, -4_i32..5, -4_i32..5).prop_map(|(a, b, c)| format!("{a}/{b}/{c}")),
        any::<f32>().prop_map(|x| x.to_string()),
        "\\PC{0,6}",
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn no_obj_file_brings_the_program_down(words in proptest::collection::vec(obj_word(), 0..60), start in prop::bool::ANY) {
        let start = if start { CUBE } else { "" };
        if let Ok(scene) = load_mesh("any.obj", format!("{start}{}", words.join(" ")).as_bytes()) {
            prop_assert!(scene.check().is_ok());
        }
    }

    #[test]
    fn no_gltf_file_brings_the_program_down(
        changes in proptest::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..12),
        digits in proptest::collection::vec((any::<prop::sample::Index>(), 0_u8..10), 0..4),
        cut in proptest::option::of(any::<prop::sample::Index>()),
        keep_json in prop::bool::ANY,
    ) {
        let mut bytes = binary(tetrahedron("", FACES));
        let places: Vec<usize> = (0..bytes.len() - 80).filter(|&i| bytes[i].is_ascii_digit()).collect();
        for (index, digit) in &digits {
            bytes[places[index.index(places.len())]] = b'0' + digit;
        }
        // Changes of JSON mostly end in its parser; those behind it go further.
        let first = if keep_json { bytes.len() - 80 } else { 0 };
        for (index, byte) in &changes {
            let at = first + index.index(bytes.len() - first);
            bytes[at] = *byte;
        }
        if let Some(cut) = cut {
            bytes.truncate(cut.index(bytes.len()));
        }
        if let Ok(scene) = load_mesh("any.glb", &bytes) {
            prop_assert!(scene.check().is_ok());
        }
    }
}
