//! What a SPIR-V module says of its own interface.

use std::fmt;

use spirq::prelude::*;
use spirq::ty::StructType;
use umbravox::shader::{Access, Binding, DescriptorKind, StructLayout};

/// Name, and fields as (name, offset, size); bytes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Layout {
    pub(crate) name: String,
    pub(crate) size: usize,
    pub(crate) fields: Vec<(String, usize, usize)>,
}

impl From<&StructLayout> for Layout {
    fn from(host: &StructLayout) -> Self {
        let fields = host.fields.iter();
        Self {
            name: host.name.to_owned(),
            size: host.size,
            fields: fields
                .map(|f| (f.name.to_owned(), f.offset, f.size))
                .collect(),
        }
    }
}

impl fmt::Display for Layout {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?} of {} bytes", self.fields, self.size)
    }
}

/// The interface of one module.
#[derive(Debug)]
pub(crate) struct Reflection {
    pub(crate) name: String,
    /// Structs in uniform and storage buffers, the buffer blocks themselves included where they hold more than
    /// one member.
    pub(crate) structs: Vec<Layout>,
    pub(crate) push_constants: Option<Layout>,
    /// By set and binding.
    pub(crate) bindings: Vec<Binding>,
    /// Ascending.
    pub(crate) spec_ids: Vec<u32>,
    pub(crate) local_size: [u32; 3],
    /// What could not be read.
    pub(crate) complaints: Vec<String>,
}

impl Reflection {
    pub(crate) fn new(name: &str, words: &[u32]) -> Self {
        let entry_points = ReflectConfig::new()
            .spv(words.to_vec())
            .reflect()
            .unwrap_or_else(|error| panic!("{name}: {error}"));
        let [entry] = &entry_points[..] else {
            panic!("{name}: {} entry points, not one", entry_points.len());
        };
        assert_eq!(entry.name, "main", "{name}: entry point");

        let mut module = Self {
            name: name.to_owned(),
            structs: Vec::new(),
            push_constants: None,
            bindings: Vec::new(),
            spec_ids: Vec::new(),
            local_size: local_size(name, entry),
            complaints: Vec::new(),
        };
        for variable in &entry.vars {
            module.add(variable);
        }
        module.bindings.sort_by_key(|b| (b.set, b.binding));
        module.spec_ids.sort_unstable();
        module
    }

    fn add(&mut self, variable: &Variable) {
        match variable {
            Variable::Descriptor {
                desc_bind,
                desc_ty,
                ty,
                nbind,
                ..
            } => {
                assert_eq!(*nbind, 1, "{}: {desc_bind} is an array", self.name);
                let (kind, access) = descriptor(&self.name, desc_ty);
                self.bindings.push(Binding {
                    set: desc_bind.set(),
                    binding: desc_bind.bind(),
                    kind,
                    access,
                });
                self.add_block(ty);
            }
            Variable::PushConstant { ty, .. } => {
                let Type::Struct(block) = ty else {
                    panic!("{}: push constants are no block", self.name);
                };
                // As in `add_block`, a block of one struct only wraps it.
                let inner = match &block.members[..] {
                    [member] => match &member.ty {
                        Type::Struct(inner) => inner,
                        _ => block,
                    },
                    _ => block,
                };
                self.push_constants = Some(self.layout(inner));
                for member in &block.members {
                    self.add_structs(&member.ty);
                }
            }
            Variable::SpecConstant { spec_id, .. } => self.spec_ids.push(*spec_id),
            Variable::Input { .. } | Variable::Output { .. } => {}
        }
    }

    /// A block of one member only wraps it: nothing in it can be out of order.
    fn add_block(&mut self, ty: &Type) {
        match ty {
            Type::Struct(block) if block.members.len() == 1 => {
                self.add_structs(&block.members[0].ty);
            }
            _ => self.add_structs(ty),
        }
    }

    fn add_structs(&mut self, ty: &Type) {
        match ty {
            Type::Struct(inner) => {
                let layout = self.layout(inner);
                if !self.structs.contains(&layout) {
                    self.structs.push(layout);
                }
                for member in &inner.members {
                    self.add_structs(&member.ty);
                }
            }
            Type::Array(array) => {
                let before = self.structs.len();
                self.add_structs(&array.element_ty);
                // In an array the distance of the elements is the size that the host must use.
                if let (Type::Struct(_), Some(stride), Some(element)) = (
                    &*array.element_ty,
                    array.stride,
                    self.structs.get_mut(before),
                ) {
                    element.size = stride;
                }
            }
            _ => {}
        }
    }

    /// Layout of a struct; a run-time sized array at its end is left to the host's buffer size.
    fn layout(&mut self, glsl: &StructType) -> Layout {
        let module = &self.name;
        let name = glsl.name().filter(|n| !n.is_empty()).unwrap_or_else(|| {
            self.complaints
                .push(format!("{module}: a struct has no name"));
            "?"
        });
        let mut layout = Layout {
            name: name.to_owned(),
            size: 0,
            fields: Vec::new(),
        };
        for (index, member) in glsl.members.iter().enumerate() {
            let field = member.name.as_deref().filter(|n| !n.is_empty());
            let field = field.unwrap_or_else(|| {
                let what = format!("{module}: member {index} of struct {name} has no name");
                self.complaints.push(what);
                "?"
            });
            let Some(offset) = member.offset else {
                self.complaints
                    .push(format!("{module}: {name}.{field} has no offset"));
                continue;
            };
            match (&member.ty, member.ty.nbyte()) {
                (Type::Array(array), _) if array.nelement.is_none() => {}
                (_, Some(size)) => {
                    layout.size = offset + size;
                    layout.fields.push((field.to_owned(), offset, size));
                }
                (_, None) => self
                    .complaints
                    .push(format!("{module}: {name}.{field} has no size")),
            }
        }
        layout
    }
}

fn descriptor(module: &str, ty: &DescriptorType) -> (DescriptorKind, Access) {
    match ty {
        DescriptorType::UniformBuffer() => (DescriptorKind::UniformBuffer, Access::Read),
        DescriptorType::StorageBuffer(a) => (DescriptorKind::StorageBuffer, access(*a)),
        DescriptorType::CombinedImageSampler() => {
            (DescriptorKind::CombinedImageSampler, Access::Read)
        }
        DescriptorType::SampledImage() => (DescriptorKind::SampledImage, Access::Read),
        DescriptorType::Sampler() => (DescriptorKind::Sampler, Access::Read),
        DescriptorType::StorageImage(a) => (DescriptorKind::StorageImage, access(*a)),
        DescriptorType::StorageTexelBuffer(a) => (DescriptorKind::StorageTexelBuffer, access(*a)),
        other => panic!("{module}: descriptors of kind {other:?} are not declared by any pass"),
    }
}

fn access(access: AccessType) -> Access {
    match access {
        AccessType::ReadOnly => Access::Read,
        AccessType::WriteOnly => Access::Write,
        AccessType::ReadWrite => Access::ReadWrite,
    }
}

/// The literal workgroup size.
fn local_size(module: &str, entry: &EntryPoint) -> [u32; 3] {
    let mode = entry
        .exec_modes
        .iter()
        .find(|mode| mode.exec_mode == spirq::spirv::ExecutionMode::LocalSize)
        .unwrap_or_else(|| panic!("{module}: no workgroup size"));
    let size: Vec<u32> = mode
        .operands
        .iter()
        .filter_map(|operand| match operand.value {
            ConstantValue::U32(n) => Some(n),
            _ => None,
        })
        .collect();
    size.try_into()
        .unwrap_or_else(|_| panic!("{module}: workgroup size is not literal"))
}
