//! Host mirrors of GLSL structs: plain data that knows its own layout.

/// Layout of a host mirror. Offsets and sizes in bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StructLayout {
    /// Name of the struct, the same in GLSL.
    pub name: &'static str,
    /// Size of the whole struct, bytes.
    pub size: usize,
    /// Fields in order of declaration.
    pub fields: &'static [FieldLayout],
}

/// Layout of one field of a host mirror.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FieldLayout {
    /// Name of the field, the same in GLSL.
    pub name: &'static str,
    /// From the start of the struct, bytes.
    pub offset: usize,
    /// Bytes; of an array, all elements with their stride.
    pub size: usize,
}

/// A struct that both the host and the shaders read: plain data without implicit padding.
pub trait GpuStruct: bytemuck::Pod {
    /// Name, fields, offsets and sizes.
    const LAYOUT: StructLayout;
}

/// Declares a host mirror of a GLSL struct: `repr(C)`, plain data, with its [`GpuStruct::LAYOUT`].
///
/// The names of the struct and of its fields are those of the GLSL. `bytemuck::Pod` refuses implicit padding, so
/// pair a three-component vector with a scalar, as std430 does.
macro_rules! gpu_struct {
    (
        $(#[$meta:meta])*
        $vis:vis struct $name:ident {
            $( $(#[$field_meta:meta])* $field_vis:vis $field:ident : $ty:ty ),+ $(,)?
        }
    ) => {
        $(#[$meta])*
        #[repr(C)]
        #[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
        $vis struct $name {
            $( $(#[$field_meta])* $field_vis $field: $ty, )+
        }

        impl $crate::shader::GpuStruct for $name {
            const LAYOUT: $crate::shader::StructLayout = $crate::shader::StructLayout {
                name: stringify!($name),
                size: ::core::mem::size_of::<$name>(),
                fields: &[ $( $crate::shader::FieldLayout {
                    name: stringify!($field),
                    offset: ::core::mem::offset_of!($name, $field),
                    size: ::core::mem::size_of::<$ty>(),
                }, )+ ],
            };
        }
    };
}
pub(crate) use gpu_struct;

#[cfg(test)]
mod tests {
    use super::GpuStruct;

    gpu_struct! {
        /// A ray, as std430 lays it out.
        pub(crate) struct Ray {
            /// mm.
            pub(crate) origin_ws: [f32; 3],
            /// mm.
            pub(crate) t_min_ws: f32,
            /// Unit length.
            pub(crate) direction_ws: [f32; 3],
            /// mm.
            pub(crate) t_max_ws: f32,
        }
    }

    #[test]
    fn layout_lists_every_field_with_its_place() {
        let layout = Ray::LAYOUT;
        let fields: Vec<_> = layout
            .fields
            .iter()
            .map(|f| (f.name, f.offset, f.size))
            .collect();
        assert_eq!((layout.name, layout.size), ("Ray", 32));
        assert_eq!(
            fields,
            [
                ("origin_ws", 0, 12),
                ("t_min_ws", 12, 4),
                ("direction_ws", 16, 12),
                ("t_max_ws", 28, 4),
            ]
        );
    }
}
