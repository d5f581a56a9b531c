//! Whole runs of the task in scratch repositories.

use super::*;

/// A repository with one shader that includes a file.
fn repository() -> tempfile::TempDir {
    let root = tempfile::tempdir().unwrap();
    fs::create_dir_all(root.path().join("glsl/include")).unwrap();
    fs::create_dir_all(root.path().join("src/shader")).unwrap();
    write(
        &root,
        "glsl/include/bindings.glsl",
        "#define SET_DATA 0\n#define BINDING_VALUES 0\n",
    );
    write(
        &root,
        "glsl/fill.comp",
        "#version 460\n\
         #extension GL_GOOGLE_include_directive : require\n\
         #include \"bindings.glsl\"\n\
         layout(local_size_x = 64) in;\n\
         layout(set = SET_DATA, binding = BINDING_VALUES) writeonly buffer Values { float b_values[]; };\n\
         #ifndef VALUE\n#define VALUE 0.0\n#endif\n\
         void main() { b_values[gl_GlobalInvocationID.x] = VALUE; }\n",
    );
    write(
        &root,
        "glsl/permutations.txt",
        "fill_one fill.comp -DVALUE=1.0\n",
    );
    root
}

fn write(root: &tempfile::TempDir, path: &str, text: &str) {
    fs::write(root.path().join(path), text).unwrap();
}

/// A manifest as `build` would leave it, with stand-ins for the SPIR-V: needs no compiler.
fn pretend_built(root: &tempfile::TempDir) {
    let paths = Paths::new(root.path());
    let shaders = source::discover(&paths.glsl).unwrap();
    fs::create_dir_all(&paths.spirv).unwrap();
    let mut manifest = Manifest {
        compiler: "a compiler that is not here".to_owned(),
        flags: FLAGS.map(str::to_owned).to_vec(),
        modules: BTreeMap::new(),
    };
    for shader in &shaders {
        fs::write(paths.module(&shader.name), shader.name.as_bytes()).unwrap();
        let record = ModuleRecord::new(shader, shader.name.as_bytes());
        manifest.modules.insert(shader.name.clone(), record);
    }
    manifest.write(&paths.manifest).unwrap();
    fs::write(&paths.generated, generate_rust(&paths, &shaders).unwrap()).unwrap();
}

fn complaint(root: &tempfile::TempDir) -> String {
    check(root.path()).unwrap_err().to_string()
}

#[test]
fn check_accepts_what_was_built_and_names_what_changed() {
    let root = repository();
    pretend_built(&root);
    check(root.path()).unwrap();

    write(
        &root,
        "glsl/include/bindings.glsl",
        "#define SET_DATA 0\n#define BINDING_VALUES 3\n",
    );
    let said = complaint(&root);
    for part in ["fill: fill.comp or what it", "fill_one:", "generated.rs"] {
        assert!(said.contains(part), "{part:?} is not in {said:?}");
    }
}

#[test]
fn check_names_changed_defines_edited_spirv_and_orphans() {
    let root = repository();
    pretend_built(&root);
    write(
        &root,
        "glsl/permutations.txt",
        "fill_one fill.comp -DVALUE=2.0\n",
    );
    write(&root, "spirv/fill.spv", "edited");
    write(&root, "spirv/old.spv", "old");
    let said = complaint(&root);
    for part in [
        "fill_one: fill.comp",
        "spirv/fill.spv was changed by hand",
        "old: no source",
    ] {
        assert!(said.contains(part), "{part:?} is not in {said:?}");
    }
}

#[test]
fn a_repository_without_shaders_is_up_to_date_after_a_build_of_nothing() {
    let root = tempfile::tempdir().unwrap();
    fs::create_dir_all(root.path().join("src/shader")).unwrap();
    pretend_built(&root);
    assert!(check(root.path()).unwrap().starts_with("0 modules"));
}

/// Runs where the compiler is; elsewhere there is nothing to compare with.
#[test]
fn build_satisfies_check_and_is_reproducible() {
    let Ok(_) = Compiler::find() else { return };
    let root = repository();
    build(root.path()).unwrap();
    let first = fs::read(root.path().join("spirv/fill_one.spv")).unwrap();
    assert!(check(root.path()).unwrap().contains("sources and bytes"));
    build(root.path()).unwrap();
    let second = fs::read(root.path().join("spirv/fill_one.spv")).unwrap();
    assert_eq!(first, second);

    write(&root, "glsl/fill.comp", "#version 460\nvoid main() { x }\n");
    let said = format!("{:#}", build(root.path()).unwrap_err());
    assert!(said.contains("fill.comp:2"), "{said}");
    let kept = fs::read(root.path().join("spirv/fill_one.spv")).unwrap();
    assert_eq!(first, kept, "a failed build leaves the stored modules");
}
