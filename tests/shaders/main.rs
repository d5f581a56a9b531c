//! The SPIR-V in `spirv/` against what the host declares in `umbravox::shader`: struct layouts, push constants,
//! descriptors, specialization constants and workgroup sizes.

mod reflection;

use std::collections::BTreeSet;
use std::path::Path;

use reflection::{Layout, Reflection};
use umbravox::shader::{PASSES, StructLayout, generated, structs};

/// What Vulkan 1.2 guarantees of `maxPushConstantsSize`.
const MAX_PUSH_CONSTANTS: usize = 128;

/// Fails with every complaint, one a line.
fn assert_none(complaints: &[String]) {
    assert!(complaints.is_empty(), "\n  {}", complaints.join("\n  "));
}

/// Differences between the structs of a module and the host's mirrors.
fn compare_structs(module: &Reflection, mirrors: &[StructLayout]) -> Vec<String> {
    let name = &module.name;
    let mut complaints = module.complaints.clone();
    for glsl in &module.structs {
        match mirrors.iter().find(|mirror| mirror.name == glsl.name) {
            None => complaints.push(format!("{name}: struct {} has no host mirror", glsl.name)),
            Some(mirror) if *glsl != Layout::from(mirror) => complaints.push(format!(
                "{name}: struct {}: GLSL {glsl} != host {}",
                glsl.name,
                Layout::from(mirror)
            )),
            Some(_) => {}
        }
    }
    complaints
}

/// Differences between the push constants of a module and their mirror.
fn compare_push_constants(module: &Reflection, mirror: Option<&StructLayout>) -> Vec<String> {
    let name = &module.name;
    let host = mirror.map(Layout::from);
    let mut complaints = Vec::new();
    if let Some(host) = &host
        && host.size > MAX_PUSH_CONSTANTS
    {
        complaints.push(format!(
            "{name}: {} bytes of push constants, at most {MAX_PUSH_CONSTANTS} are portable",
            host.size
        ));
    }
    if module.push_constants != host {
        let show = |layout: &Option<Layout>| match layout {
            Some(layout) => format!("{} {layout}", layout.name),
            None => "none".to_owned(),
        };
        complaints.push(format!(
            "{name}: push constants: GLSL {} != host {}",
            show(&module.push_constants),
            show(&host)
        ));
    }
    complaints
}

/// Every module in `spirv/`.
fn modules() -> Vec<Reflection> {
    generated::MODULES
        .iter()
        .map(|module| Reflection::new(module.name, module.words))
        .collect()
}

#[test]
fn structs_equal_their_host_mirrors() {
    let modules = modules();
    let mut complaints: Vec<String> = modules
        .iter()
        .flat_map(|module| compare_structs(module, structs::ALL))
        .collect();
    let in_glsl: BTreeSet<&str> = modules
        .iter()
        .flat_map(|module| module.structs.iter().chain(&module.push_constants))
        .map(|layout| layout.name.as_str())
        .collect();
    let unused = structs::ALL.iter().filter(|m| !in_glsl.contains(m.name));
    complaints.extend(unused.map(|m| format!("host mirror {} is in no module", m.name)));
    assert_none(&complaints);
}

#[test]
fn push_constants_equal_their_host_mirrors_and_are_portable() {
    let complaints: Vec<String> = PASSES
        .iter()
        .flat_map(|pass| {
            let module = Reflection::new(pass.module.name, pass.module.words);
            compare_push_constants(&module, pass.push_constants.as_ref())
        })
        .collect();
    assert_none(&complaints);
}

#[test]
fn passes_declare_what_their_modules_use() {
    for pass in PASSES {
        let module = Reflection::new(pass.module.name, pass.module.words);
        let name = &module.name;
        assert_eq!(module.bindings, pass.bindings, "{name}: descriptors");
        assert_eq!(
            module.spec_ids, pass.spec_ids,
            "{name}: specialization constants"
        );
        assert_eq!(module.local_size, pass.local_size, "{name}: workgroup size");
    }
}

#[test]
fn every_stored_module_belongs_to_a_pass() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("spirv");
    let stored: BTreeSet<String> = std::fs::read_dir(&folder)
        .expect("spirv/ is in the repository")
        .map(|entry| entry.expect("a readable folder").path())
        .filter(|path| path.extension().is_some_and(|e| e == "spv"))
        .filter_map(|path| Some(path.file_stem()?.to_str()?.to_owned()))
        .collect();
    let in_passes: BTreeSet<String> = PASSES.iter().map(|p| p.module.name.to_owned()).collect();
    let generated: BTreeSet<String> = generated::MODULES
        .iter()
        .map(|module| module.name.to_owned())
        .collect();
    assert_eq!(stored, generated, "spirv/ and src/shader/generated.rs");
    assert_eq!(stored, in_passes, "spirv/ and umbravox::shader::PASSES");
}

/// The checks above, on a small module: each kind of mistake is noticed.
mod fixture {
    use umbravox::shader::{Access, Binding, DescriptorKind, FieldLayout};

    use super::*;

    const FRAME: StructLayout = StructLayout {
        name: "Frame",
        size: 80,
        fields: &[
            field("world_from_clip", 0, 64),
            field("eye_ws", 64, 12),
            field("step_ws", 76, 4),
        ],
    };
    const BLOCK: StructLayout = StructLayout {
        name: "Block",
        size: 16,
        fields: &[field("origin_ix", 0, 12), field("level", 12, 4)],
    };
    const REQUESTS: StructLayout = StructLayout {
        name: "Requests",
        size: 8,
        fields: &[field("count", 0, 4), field("capacity", 4, 4)],
    };
    const PUSH: StructLayout = StructLayout {
        name: "FixturePush",
        size: 12,
        fields: &[field("tile_px", 0, 8), field("frame", 8, 4)],
    };

    const fn field(name: &'static str, offset: usize, size: usize) -> FieldLayout {
        FieldLayout { name, offset, size }
    }

    fn words() -> Vec<u32> {
        include_bytes!("../data/shaders/fixture.spv")
            .chunks_exact(4)
            .map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]))
            .collect()
    }

    fn reflect() -> Reflection {
        Reflection::new("fixture", &words())
    }

    #[test]
    fn equal_layouts_are_accepted() {
        assert_none(&compare_structs(&reflect(), &[FRAME, BLOCK, REQUESTS]));
        assert_none(&compare_push_constants(&reflect(), Some(&PUSH)));
    }

    #[test]
    fn swapped_fields_are_noticed() {
        const SWAPPED: StructLayout = StructLayout {
            fields: &[
                field("world_from_clip", 0, 64),
                field("step_ws", 64, 4),
                field("eye_ws", 68, 12),
            ],
            ..FRAME
        };
        let complaints = compare_structs(&reflect(), &[SWAPPED, BLOCK, REQUESTS]);
        assert_eq!(complaints.len(), 1, "{complaints:?}");
        assert!(complaints[0].contains("struct Frame"), "{complaints:?}");
    }

    #[test]
    fn an_array_stride_unlike_the_mirror_is_noticed() {
        let longer = StructLayout { size: 32, ..BLOCK };
        let complaints = compare_structs(&reflect(), &[FRAME, longer, REQUESTS]);
        assert_eq!(complaints.len(), 1, "{complaints:?}");
        assert!(complaints[0].contains("struct Block"), "{complaints:?}");
    }

    #[test]
    fn a_struct_without_mirror_is_noticed() {
        let complaints = compare_structs(&reflect(), &[FRAME, REQUESTS]);
        assert_eq!(complaints, ["fixture: struct Block has no host mirror"]);
    }

    #[test]
    fn push_constants_unlike_their_mirror_are_noticed() {
        assert_eq!(compare_push_constants(&reflect(), None).len(), 1);
        assert_eq!(compare_push_constants(&reflect(), Some(&BLOCK)).len(), 1);
        let large = StructLayout { size: 132, ..PUSH };
        let complaints = compare_push_constants(&reflect(), Some(&large));
        assert!(complaints[0].contains("132 bytes"), "{complaints:?}");
    }

    #[test]
    fn stripped_names_are_noticed() {
        const OP_NAME: u32 = 5;
        const OP_MEMBER_NAME: u32 = 6;
        let words = words();
        let mut stripped = words[..5].to_vec(); // the header
        let mut rest = &words[5..];
        while let [first, ..] = rest {
            // An instruction starts with its length in words and its opcode.
            let (instruction, next) = rest.split_at((first >> 16) as usize);
            if ![OP_NAME, OP_MEMBER_NAME].contains(&(first & 0xffff)) {
                stripped.extend_from_slice(instruction);
            }
            rest = next;
        }
        let module = Reflection::new("stripped", &stripped);
        let complaints = compare_structs(&module, &[FRAME, BLOCK, REQUESTS]);
        assert!(
            complaints.iter().any(|c| c.contains("has no name")),
            "{complaints:?}"
        );
    }

    #[test]
    fn descriptors_spec_ids_and_workgroup_size_are_read() {
        let module = reflect();
        let binding = |set, binding, kind, access| Binding {
            set,
            binding,
            kind,
            access,
        };
        let expected = [
            binding(0, 0, DescriptorKind::UniformBuffer, Access::Read),
            binding(0, 1, DescriptorKind::StorageBuffer, Access::Read),
            binding(0, 2, DescriptorKind::StorageBuffer, Access::ReadWrite),
            binding(1, 0, DescriptorKind::CombinedImageSampler, Access::Read),
            binding(1, 3, DescriptorKind::StorageImage, Access::Write),
        ];
        assert_eq!(module.bindings, expected);
        assert_eq!(module.spec_ids, [7]);
        assert_eq!(module.local_size, [8, 4, 1]);
    }
}
