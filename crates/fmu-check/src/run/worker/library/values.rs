//! Values of variables, read and written by the functions of their types.

use super::instance::Instance;
use super::status::Refused;
use super::{Component, Status, Text};
use crate::description::Kind;
use libc::{c_uint, size_t};
use std::ffi::{CStr, CString};
use std::fmt;
use std::ptr;

pub(super) type Get<T> = unsafe extern "C" fn(Component, *const c_uint, size_t, *mut T) -> Status;
pub(super) type Set<T> = unsafe extern "C" fn(Component, *const c_uint, size_t, *const T) -> Status;

/// The value of a variable.
#[derive(Clone, Debug)]
pub(crate) enum Value {
    Real(f64),
    /// Also of an enumeration.
    Integer(i32),
    Boolean(bool),
    String(String),
}

impl Value {
    /// `true` if the values are the same for a host. Unlike equality this holds for two NaN.
    pub(crate) fn is_same(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Real(one), Self::Real(other)) => one == other || one.is_nan() && other.is_nan(),
            (Self::Integer(one), Self::Integer(other)) => one == other,
            (Self::Boolean(one), Self::Boolean(other)) => one == other,
            (Self::String(one), Self::String(other)) => one == other,
            _ => false,
        }
    }

    /// `true` if a value that was stated or set is the one that is found, if only in single precision.
    pub(crate) fn agrees_with(&self, found: &Self) -> bool {
        match (self, found) {
            (Self::Real(stated), Self::Real(found)) => {
                (stated - found).abs() <= 1e-6 * stated.abs()
            }
            _ => self.is_same(found),
        }
    }

    pub(super) fn kind(&self) -> Kind {
        match self {
            Self::Real(_) => Kind::Real,
            Self::Integer(_) => Kind::Integer,
            Self::Boolean(_) => Kind::Boolean,
            Self::String(_) => Kind::String,
        }
    }

    /// The value as FMI passes an Integer or a Boolean; `None` if it is of another type.
    pub(super) fn integer(&self) -> Option<i32> {
        match self {
            Self::Integer(value) => Some(*value),
            Self::Boolean(value) => Some(i32::from(*value)),
            _ => None,
        }
    }

    fn text(&self) -> Option<CString> {
        if let Self::String(value) = self { CString::new(value.as_str()).ok() } else { None }
    }

    /// The value as a Real; `None` if it is of another type.
    pub(crate) fn real(&self) -> Option<f64> {
        if let Self::Real(value) = self { Some(*value) } else { None }
    }
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Real(value) => write!(f, "{value:?}"),
            Self::Integer(value) => write!(f, "{value}"),
            Self::Boolean(value) => write!(f, "{value}"),
            Self::String(value) => write!(f, "{value:?}"),
        }
    }
}

/// Name of the function that reads or writes variables of a type: `verb` is `Get` or `Set`.
pub(crate) fn function(verb: &str, kind: Kind) -> String {
    let kind = match kind.base() {
        Kind::Real => "Real",
        Kind::Integer | Kind::Enumeration => "Integer",
        Kind::Boolean => "Boolean",
        Kind::String => "String",
    };
    format!("fmi2{verb}{kind}")
}

impl Instance<'_> {
    /// Reads variables of one type in one call.
    pub(crate) fn read(&self, kind: Kind, references: &[u32]) -> Result<Vec<Value>, Refused> {
        Ok(match kind.base() {
            Kind::Real => self.get(kind, references, 0.0)?.into_iter().map(Value::Real).collect(),
            Kind::Integer | Kind::Enumeration => {
                self.get(kind, references, 0)?.into_iter().map(Value::Integer).collect()
            }
            Kind::Boolean => {
                let read = self.get(kind, references, 0_i32)?;
                let boolean = |value| match value {
                    0 | 1 => Ok(Value::Boolean(value == 1)),
                    _ => Err(Refused::NoBoolean(value)),
                };
                return read.into_iter().map(boolean).collect();
            }
            Kind::String => {
                let read: Vec<Text> = self.get(kind, references, ptr::null())?;
                let text = |value: &Text| {
                    if value.is_null() {
                        return String::new();
                    }
                    // SAFETY: the strings are valid until the next call.
                    unsafe { CStr::from_ptr(*value) }.to_string_lossy().into_owned()
                };
                read.iter().map(|value| Value::String(text(value))).collect()
            }
        })
    }

    fn get<T: Copy>(&self, kind: Kind, references: &[u32], empty: T) -> Result<Vec<T>, Refused> {
        let function = self.function::<Get<T>>(&function("Get", kind))?;
        let mut values = vec![empty; references.len()];
        // SAFETY: the component is alive and the arrays are of the length that is stated.
        self.succeeded(unsafe {
            function(self.component(), references.as_ptr(), references.len(), values.as_mut_ptr())
        })?;
        Ok(values)
    }

    /// Sets variables of one type in one call; the values are of that type.
    pub(crate) fn write(&self, values: &[(u32, &Value)]) -> Result<(), Refused> {
        let Some((_, first)) = values.first() else { return Ok(()) };
        let kind = first.kind();
        let all = values.iter().map(|(_, value)| *value);
        match kind.base() {
            Kind::Real => {
                self.set(kind, values, &all.filter_map(Value::real).collect::<Vec<f64>>())
            }
            Kind::String => {
                let texts: Vec<CString> = all.filter_map(Value::text).collect();
                self.set(
                    kind,
                    values,
                    &texts.iter().map(|text| text.as_ptr()).collect::<Vec<Text>>(),
                )
            }
            _ => self.set(kind, values, &all.filter_map(Value::integer).collect::<Vec<i32>>()),
        }
    }

    fn set<T>(&self, kind: Kind, asked: &[(u32, &Value)], values: &[T]) -> Result<(), Refused> {
        let function = self.function::<Set<T>>(&function("Set", kind))?;
        let references: Vec<u32> = asked.iter().map(|(reference, _)| *reference).collect();
        assert_eq!(references.len(), values.len());
        // SAFETY: the component is alive and the arrays are of the length that is stated.
        self.succeeded(unsafe {
            function(self.component(), references.as_ptr(), references.len(), values.as_ptr())
        })
    }
}
