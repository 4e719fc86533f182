//! That nothing of what is left out is missed: pictures with all pruning beside pictures with none.

mod common;

use common::{folder, meniscus, text, words, write};
use meniscus::gpu::Gpu;
use meniscus::scene::Setting;
use meniscus::{Project, Proof, Sources};

/// Configurations of pipelines and scenes; together more than 200, small, so that all are quick.
const TRIED: &[(&str, &str, u32)] = &[
    ("refraction/bounded", "pool", 50),
    ("refraction/combined", "straddle", 45),
    ("refraction/refined", "underwater", 30),
    ("refraction/screen-space", "pool", 25),
    ("refraction/offset", "straddle", 25),
    ("refraction/ray-traced", "coarse", 15),
    ("refraction/none", "pool", 15),
];

#[test]
fn nothing_that_is_left_out_is_missed_in_two_hundred_configurations() {
    let project = Project::open(&Sources::default()).unwrap_or_else(|e| panic!("{e}"));
    let gpu = Gpu::open(None).unwrap_or_else(|e| panic!("{e}"));
    let (mut cases, mut approximate, mut ran) = (0, 0, [0, 0]);
    for &(pipeline, scene, number) in TRIED {
        let pipeline = project.pipeline(pipeline).unwrap();
        // Where the scene has no pool, there is nothing to set.
        let coarse = [Setting::new("pool.triangles", "500")];
        let settings = match scene {
            "pool" => &coarse[..],
            _ => &[],
        };
        let proof = Proof {
            pipeline: &pipeline,
            scene,
            settings,
            size: [40, 30],
            cases: number,
            seed: 7,
        };
        let proved = proof
            .run(&project, &gpu, &|_, _| {})
            .unwrap_or_else(|e| panic!("{e}"));
        let told: Vec<String> = proved.differences.iter().map(ToString::to_string).collect();
        assert!(
            told.is_empty(),
            "{} in {scene}:\n{}",
            pipeline.name,
            told.join("\n")
        );
        cases += proved.cases;
        approximate += proved.approximate;
        ran = [ran[0] + proved.passes[0], ran[1] + proved.passes[1]];
    }
    assert!(cases >= 200, "{cases}");
    // What was proved is worth something: much was left out.
    assert!(
        approximate > 0 && 4 * ran[0] < 3 * ran[1],
        "{approximate} {ran:?}"
    );
}

#[test]
fn a_pass_that_is_wrongly_said_to_be_over_the_water_is_found() {
    let there = folder();
    let file = there.path().join("wrong.ron");
    // The sky is where no water is; nothing draws it there.
    write(
        &file,
        r#"Pipeline(
    about: "A sky that is said to be over the water.",
    textures: {
        "frame":       (format: Rgba16Float, size: Frame),
        "front_depth": (format: Depth32Float, size: Frame),
    },
    sequence: [
        Draw(name: "all", skeleton: "passes/surface", geometry: All,
            slots: { "shade": "shading/diffuse" },
            writes: { "colour": "frame", "depth": "front_depth" }),
        Screen(name: "sky", over: Water, skeleton: "passes/sky",
            writes: { "colour": "frame" }),
    ],
    output: (colour: "frame"),
)"#,
    );
    let line = "--scene pool --set pool.triangles=500 --size 40x30 --cases 12 --seed 3";
    let mut arguments = vec!["prove", text(&file)];
    arguments.extend(words(line));
    let said = meniscus(arguments);
    said.ended(
        1,
        &["`frame` differs", "with all pruning", "meniscus prove"],
    );
    // The command that is told finds it again, alone.
    let command = said
        .err
        .lines()
        .find(|line| line.trim().starts_with("meniscus prove"));
    let command = command.expect("a command").trim().replace('\'', "");
    let again = meniscus(command.split_whitespace().skip(1));
    again.ended(1, &["case 0", "`frame` differs"]);
}

#[test]
fn a_module_that_wrongly_says_that_it_changes_nothing_is_found() {
    let there = folder();
    let modules = there.path().join("modules");
    let file = "shader-modules/geometry/tangent_plane.wgsl";
    let honest = std::fs::read_to_string(file).expect("the module");
    let line = honest
        .lines()
        .find(|line| line.starts_with("// identity when"));
    let wrong = honest.replace(
        line.expect("a line on the identity"),
        "// identity when not camera_submerged: exactly",
    );
    write(&modules.join("geometry/tangent_plane.wgsl"), wrong);
    for (path, when) in [
        ("optics/refracted_ray", "not camera_submerged"),
        ("screen/through_flat_water", "not camera_submerged"),
        ("geometry/refined", "not camera_submerged"),
    ] {
        let honest = std::fs::read_to_string(format!("shader-modules/{path}.wgsl")).unwrap();
        let line = honest
            .lines()
            .find(|line| line.starts_with("// identity when"));
        let line = line.expect("a line on the identity");
        let wrong = honest.replace(line, &format!("// identity when {when}: exactly"));
        write(&modules.join(format!("{path}.wgsl")), wrong);
    }
    let line = "prove refraction/combined --scene pool --set pool.triangles=500 --size 40x30 --cases 12 \
        --modules";
    let mut arguments = words(line);
    arguments.push(text(&modules));
    meniscus(arguments).ended(1, &["differs", "with all pruning"]);
}

#[test]
fn a_module_that_wrongly_says_where_points_appear_is_found() {
    let there = folder();
    let modules = there.path().join("modules");
    let path = "optics/apparent_position";
    let honest = std::fs::read_to_string(format!("shader-modules/{path}.wgsl")).unwrap();
    let wrong = honest.replace("appears: on its vertical", "appears: in place");
    assert_ne!(wrong, honest);
    write(&modules.join(format!("{path}.wgsl")), wrong);
    let line = "prove refraction/bounded --scene pool --set camera.field_of_view=20 --size 40x30 \
        --set camera.target.z=0 --cases 6 --modules";
    let mut arguments = words(line);
    arguments.push(text(&modules));
    meniscus(arguments).ended(1, &["differs", "with all pruning"]);
    let unknown = honest.replace("appears: on its vertical", "appears: on its vertica");
    write(&modules.join(format!("{path}.wgsl")), unknown);
    let mut arguments = words("check --modules");
    arguments.push(text(&modules));
    let told = [
        "apparent_position.wgsl:5:",
        "did you mean `on its vertical`?",
    ];
    meniscus(arguments).refused(&told);
}

#[test]
fn a_promise_of_less_than_is_kept_is_found() {
    let there = folder();
    let modules = there.path().join("modules");
    let path = "geometry/tangent_plane";
    let honest = std::fs::read_to_string(format!("shader-modules/{path}.wgsl")).unwrap();
    let line = honest
        .lines()
        .find(|line| line.starts_with("// identity when"));
    let line = line.expect("a line on the identity");
    let (facts, _) = line.split_once(": within").expect("a promise");
    let wrong = honest.replace(line, &format!("{facts}: within 0.0001 px"));
    write(&modules.join(format!("{path}.wgsl")), wrong);
    let line = "prove refraction/bounded --scene straddle --set water.rms_slope=0 --size 64x48 --cases 12 \
        --modules";
    let mut arguments = words(line);
    arguments.push(text(&modules));
    meniscus(arguments).ended(1, &["off by more than 0.02", "object"]);
}

#[test]
fn a_proof_says_what_was_compared() {
    let line = "prove refraction/none --scene pool --set pool.triangles=500 --size 16x9 --cases 2";
    let said = meniscus(words(line)).done();
    assert!(
        said.contains("no difference in") && said.contains("3 configurations"),
        "{said}"
    );
    let wrong = "prove refraction/none --scene nowhere --cases 1";
    meniscus(words(wrong)).refused(&["nowhere"]);
}
