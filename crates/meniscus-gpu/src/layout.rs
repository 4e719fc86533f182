//! Values by name into the layout that naga gives a type, so that no struct is declared twice.

use naga::{ArraySize, Handle, Module, ScalarKind, Type, TypeInner, VectorSize};

/// A value of the host.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Value {
    F32(f32),
    U32(u32),
    Vec2([f32; 2]),
    Vec3([f32; 3]),
}

impl Value {
    fn bytes(&self) -> Vec<u8> {
        match self {
            Self::F32(v) => bytemuck::bytes_of(v).to_vec(),
            Self::U32(v) => bytemuck::bytes_of(v).to_vec(),
            Self::Vec2(v) => bytemuck::bytes_of(v).to_vec(),
            Self::Vec3(v) => bytemuck::bytes_of(v).to_vec(),
        }
    }

    fn is_finite(&self) -> bool {
        match self {
            Self::F32(v) => v.is_finite(),
            Self::U32(_) => true,
            Self::Vec2(v) => v.iter().all(|x| x.is_finite()),
            Self::Vec3(v) => v.iter().all(|x| x.is_finite()),
        }
    }

    fn fits(&self, inner: &TypeInner) -> bool {
        let (size, scalar) = match *inner {
            TypeInner::Scalar(scalar) => (None, scalar),
            TypeInner::Vector { size, scalar } => (Some(size), scalar),
            _ => return false,
        };
        let (expected, kind) = match self {
            Self::F32(_) => (None, ScalarKind::Float),
            Self::U32(_) => (None, ScalarKind::Uint),
            Self::Vec2(_) => (Some(VectorSize::Bi), ScalarKind::Float),
            Self::Vec3(_) => (Some(VectorSize::Tri), ScalarKind::Float),
        };
        size == expected && scalar.kind == kind && scalar.width == 4
    }

    /// WGSL's name of the type.
    fn wgsl(&self) -> &'static str {
        match self {
            Self::F32(_) => "f32",
            Self::U32(_) => "u32",
            Self::Vec2(_) => "vec2f",
            Self::Vec3(_) => "vec3f",
        }
    }
}

/// Values of a block by the names of its members.
pub(crate) trait Values {
    /// A member that is one value.
    fn value(&self, member: &str) -> Option<Value>;

    /// The number of elements of a member that is an array of structs; none if it is not.
    fn length(&self, _array: &str) -> Option<usize> {
        None
    }

    /// A member of such an array's element, which is in range.
    fn element(&self, _array: &str, _index: usize, _member: &str) -> Option<Value> {
        None
    }
}

impl<F: Fn(&str) -> Option<Value>> Values for F {
    fn value(&self, member: &str) -> Option<Value> {
        self(member)
    }
}

/// The bytes of a uniform block: each member of the struct where naga puts it. Of arrays in it, as
/// many elements as it has room for, and zeros behind the last.
///
/// # Errors
/// When the type is no struct, when the host has no such member or has it with another type, and
/// when a value is not finite in single precision.
pub(crate) fn block_bytes(
    module: &Module,
    ty: Handle<Type>,
    values: &dyn Values,
) -> Result<Vec<u8>, String> {
    let TypeInner::Struct { ref members, span } = module.types[ty].inner else {
        return Err("it is to be declared as a struct".to_owned());
    };
    let mut bytes = vec![0; span as usize];
    for member in members {
        let name = member.name.as_deref().unwrap_or_default();
        let start = member.offset as usize;
        if let Some(length) = values.length(name) {
            let element = |index: usize, member: &str| values.element(name, index, member);
            let inner = member_array_bytes(module, member.ty, length, &element)
                .map_err(|problem| format!("its member `{name}`: {problem}"))?;
            bytes[start..start + inner.len()].copy_from_slice(&inner);
            continue;
        }
        let Some(value) = values.value(name) else {
            return Err(format!("the host has no member `{name}` in it"));
        };
        if !value.fits(&module.types[member.ty].inner) {
            return Err(format!("its member `{name}` is of type {}", value.wgsl()));
        }
        if !value.is_finite() {
            return Err(format!(
                "its member `{name}` is not finite in single precision"
            ));
        }
        let value = value.bytes();
        bytes[start..start + value.len()].copy_from_slice(&value);
    }
    Ok(bytes)
}

/// The bytes of an array of structs in a block.
fn member_array_bytes(
    module: &Module,
    ty: Handle<Type>,
    count: usize,
    value: &dyn Fn(usize, &str) -> Option<Value>,
) -> Result<Vec<u8>, String> {
    match module.types[ty].inner {
        TypeInner::Array {
            size: ArraySize::Constant(length),
            ..
        } => array_bytes(module, ty, count.min(length.get() as usize), value),
        _ => Err("it is to be declared as an array of structs of a known length".to_owned()),
    }
}

/// The bytes of an array of structs; at least one element, which is 0 where there is none.
///
/// # Errors
/// As [`block_bytes`]; when the type is no array of structs, or too short an array.
pub(crate) fn array_bytes(
    module: &Module,
    ty: Handle<Type>,
    count: usize,
    value: &dyn Fn(usize, &str) -> Option<Value>,
) -> Result<Vec<u8>, String> {
    let TypeInner::Array { base, size, stride } = module.types[ty].inner else {
        return Err("it is to be declared as an array of structs".to_owned());
    };
    let length = match size {
        ArraySize::Dynamic => count.max(1),
        ArraySize::Constant(length) if length.get() as usize >= count => length.get() as usize,
        ArraySize::Constant(length) => {
            return Err(format!(
                "it has {count} elements, and {length} are declared"
            ));
        }
        ArraySize::Pending(_) => return Err("its length is to be known or left out".to_owned()),
    };
    let mut bytes = vec![0; stride as usize * length];
    for index in 0..count {
        let element = block_bytes(module, base, &|name: &str| value(index, name))?;
        let start = index * stride as usize;
        bytes[start..start + element.len()].copy_from_slice(&element);
    }
    Ok(bytes)
}

/// One member of all elements of an array.
pub(crate) enum Column<'a> {
    F32(Box<dyn Fn(usize) -> f32 + 'a>),
    U32(Box<dyn Fn(usize) -> u32 + 'a>),
    Vec3(Box<dyn Fn(usize) -> glam::Vec3 + 'a>),
}

impl<'a> Column<'a> {
    pub fn f32(value: impl Fn(usize) -> f32 + 'a) -> Self {
        Self::F32(Box::new(value))
    }

    pub fn u32(value: impl Fn(usize) -> u32 + 'a) -> Self {
        Self::U32(Box::new(value))
    }

    pub fn vec3(value: impl Fn(usize) -> glam::Vec3 + 'a) -> Self {
        Self::Vec3(Box::new(value))
    }

    /// Any value of its type.
    fn sample(&self) -> Value {
        match self {
            Self::F32(_) => Value::F32(0.0),
            Self::U32(_) => Value::U32(0),
            Self::Vec3(_) => Value::Vec3([0.0; 3]),
        }
    }
}

/// The bytes of a large array of structs, member by member, so that names are looked up once.
///
/// # Errors
/// When the type is no array of structs of unknown length, and when the host has no such member or
/// has it with another type.
pub(crate) fn column_bytes<'a>(
    module: &Module,
    ty: Handle<Type>,
    count: usize,
    column: impl Fn(&str) -> Option<Column<'a>>,
) -> Result<Vec<u8>, String> {
    let TypeInner::Array {
        base,
        size: ArraySize::Dynamic,
        stride,
    } = &module.types[ty].inner
    else {
        return Err("it is to be declared as an array of structs without a length".to_owned());
    };
    let TypeInner::Struct { members, .. } = &module.types[*base].inner else {
        return Err("it is to be declared as an array of structs".to_owned());
    };
    let stride = *stride as usize;
    let mut bytes = vec![0; stride * count];
    for member in members {
        let name = member.name.as_deref().unwrap_or_default();
        let Some(column) = column(name) else {
            return Err(format!("the host has no member `{name}` in it"));
        };
        let sample = column.sample();
        if !sample.fits(&module.types[member.ty].inner) {
            return Err(format!("its member `{name}` is of type {}", sample.wgsl()));
        }
        let offset = member.offset as usize;
        let elements = bytes.chunks_exact_mut(stride).enumerate();
        match column {
            Column::F32(value) => {
                for (index, element) in elements {
                    element[offset..offset + 4].copy_from_slice(bytemuck::bytes_of(&value(index)));
                }
            }
            Column::U32(value) => {
                for (index, element) in elements {
                    element[offset..offset + 4].copy_from_slice(bytemuck::bytes_of(&value(index)));
                }
            }
            Column::Vec3(value) => {
                for (index, element) in elements {
                    element[offset..offset + 12].copy_from_slice(bytemuck::bytes_of(&value(index)));
                }
            }
        }
    }
    Ok(bytes)
}

/// A text that is the same for types that are written with the same bytes.
pub(crate) fn signature(module: &Module, ty: Handle<Type>) -> String {
    match &module.types[ty].inner {
        TypeInner::Struct { members, span } => {
            let member = |m: &naga::StructMember| {
                format!("{}@{}", m.name.as_deref().unwrap_or_default(), m.offset)
            };
            let members: Vec<String> = members.iter().map(member).collect();
            format!("{span}:{}", members.join(","))
        }
        TypeInner::Array { base, size, stride } => {
            format!("{size:?}*{stride}:{}", signature(module, *base))
        }
        other => format!("{other:?}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn module(text: &str) -> (Module, Handle<Type>) {
        let module = naga::front::wgsl::parse_str(text).unwrap();
        let ty = module.global_variables.iter().next().unwrap().1.ty;
        (module, ty)
    }

    fn value(name: &str) -> Option<Value> {
        Some(match name {
            "eye" => Value::Vec3([1.0, 2.0, 3.0]),
            "near" => Value::F32(4.0),
            "size" => Value::Vec2([5.0, 6.0]),
            "id" => Value::U32(7),
            "bad" => Value::F32(f32::INFINITY),
            _ => return None,
        })
    }

    fn float(bytes: &[u8], offset: usize) -> f32 {
        bytemuck::pod_read_unaligned(&bytes[offset..offset + 4])
    }

    #[test]
    fn members_stand_where_the_order_of_declaration_puts_them() {
        let (m, ty) = module(
            "struct B { near: f32, eye: vec3f, size: vec2f } @group(0) @binding(0) var<uniform> b: B;",
        );
        let bytes = block_bytes(&m, ty, &value).unwrap();
        assert_eq!(bytes.len(), 48);
        assert_eq!(
            (float(&bytes, 0), float(&bytes, 16), float(&bytes, 32)),
            (4.0, 1.0, 5.0)
        );
        let (m, ty) = module(
            "struct B { eye: vec3f, near: f32, size: vec2f } @group(0) @binding(0) var<uniform> b: B;",
        );
        let bytes = block_bytes(&m, ty, &value).unwrap();
        assert_eq!(bytes.len(), 32);
        assert_eq!(
            (float(&bytes, 12), float(&bytes, 0), float(&bytes, 20)),
            (4.0, 1.0, 6.0)
        );
    }

    #[test]
    fn an_array_is_never_empty_and_keeps_its_stride() {
        let (m, ty) =
            module("struct E { eye: vec3f } @group(0) @binding(0) var<storage> e: array<E>;");
        assert_eq!(array_bytes(&m, ty, 0, &|_, _| None).unwrap(), [0; 16]);
        let bytes =
            array_bytes(&m, ty, 2, &|i, _| Some(Value::Vec3([i as f32, 0.0, 8.0]))).unwrap();
        assert_eq!(
            (float(&bytes, 8), float(&bytes, 16), float(&bytes, 24)),
            (8.0, 1.0, 8.0)
        );
    }

    #[test]
    fn columns_are_written_as_elements_are() {
        let (m, ty) = module(
            "struct E { id: u32, eye: vec3f, other: u32 } @group(0) @binding(0) var<storage> e: array<E>;",
        );
        let eye = |i: usize| glam::Vec3::new(i as f32, 0.5, -1.0);
        let by_element = array_bytes(&m, ty, 3, &|i, name| {
            Some(match name {
                "eye" => Value::Vec3(eye(i).to_array()),
                "id" => Value::U32(i as u32 + 7),
                _ => Value::U32(u32::MAX),
            })
        });
        let by_column = column_bytes(&m, ty, 3, |name| {
            Some(match name {
                "eye" => Column::vec3(eye),
                "id" => Column::u32(|i| i as u32 + 7),
                _ => Column::u32(|_| u32::MAX),
            })
        });
        assert_eq!(by_column, by_element);
        let error = column_bytes(&m, ty, 3, |_| Some(Column::u32(|_| 0))).unwrap_err();
        assert!(error.contains("`eye` is of type u32"), "{error}");
        let error = column_bytes(&m, ty, 3, |_| None).unwrap_err();
        assert!(error.contains("no member `id`"), "{error}");
    }

    #[test]
    fn what_the_host_cannot_write_is_named() {
        for (member, message) in [
            ("other: f32", "no member `other`"),
            ("eye: vec4f", "`eye` is of type vec3f"),
            ("id: f32", "`id` is of type u32"),
            ("bad: f32", "`bad` is not finite"),
        ] {
            let text = format!("struct B {{ {member} }} @group(0) @binding(0) var<uniform> b: B;");
            let (m, ty) = module(&text);
            let error = block_bytes(&m, ty, &value).unwrap_err();
            assert!(error.contains(message), "{error}");
        }
    }
}
