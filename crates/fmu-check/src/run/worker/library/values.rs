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
    /// `true` if a host cannot tell the values apart. Unlike equality this holds for two NaN of the same bits.
    pub(crate) fn is_same(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Real(one), Self::Real(other)) => one.to_bits() == other.to_bits(),
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
                read.into_iter().map(|value| Value::Boolean(value != 0)).collect()
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

    /// Sets one variable.
    pub(crate) fn write(&self, reference: u32, value: &Value) -> Result<(), Refused> {
        match value {
            Value::Real(value) => self.set(Kind::Real, reference, *value),
            Value::Integer(value) => self.set(Kind::Integer, reference, *value),
            Value::Boolean(value) => self.set(Kind::Boolean, reference, i32::from(*value)),
            Value::String(value) => {
                let text = CString::new(value.as_str()).map_err(|_| Refused::Missing)?;
                self.set(Kind::String, reference, text.as_ptr())
            }
        }
    }

    fn set<T: Copy>(&self, kind: Kind, reference: u32, value: T) -> Result<(), Refused> {
        let function = self.function::<Set<T>>(&function("Set", kind))?;
        // SAFETY: the component is alive and both arrays have one element.
        self.succeeded(unsafe {
            function(self.component(), &raw const reference, 1, &raw const value)
        })
    }
}
