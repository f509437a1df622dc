//! The library of an FMU: an instance of it, with the functions of both versions of the standard.
//!
//! The only unsafe code of the crates: foreign functions are looked up by the names that the standard gives
//! them, and called with the types that it gives them.
#![allow(unsafe_code, reason = "foreign functions cannot be called without")]

use std::ffi::{CStr, CString, c_char, c_int, c_uint, c_void};
use std::path::Path;
use std::sync::Mutex;

use libloading::Library;

use crate::description::{Description, Type, Variable, Version};

/// A value of a variable.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// Of a Boolean.
    Bool(bool),
    /// Of a real.
    Real(f64),
    /// Of a whole number.
    Int(i128),
    /// Of a text.
    Text(String),
}

type Handle = *mut c_void;
type References = *const c_uint;
/// Functions that get or set values of FMI 2.0.
type Values2<T> = unsafe extern "C" fn(Handle, References, usize, *mut T) -> c_int;
/// Functions that get or set values of FMI 3.0.
type Values3<T> = unsafe extern "C" fn(Handle, References, usize, *mut T, usize) -> c_int;

/// The callbacks of FMI 2.0.
#[repr(C)]
struct Callbacks {
    logger:
        unsafe extern "C" fn(*mut c_void, *const c_char, c_int, *const c_char, *const c_char, *const c_char),
    allocate: unsafe extern "C" fn(usize, usize) -> *mut c_void,
    free: unsafe extern "C" fn(*mut c_void),
    finished: Option<unsafe extern "C" fn(*mut c_void, c_int)>,
    environment: *mut c_void,
}

type Messages = Mutex<Vec<String>>;

/// An instance. Dropping it frees it and unloads the library.
pub struct Instance {
    version: Version,
    handle: Handle,
    /// The messages of the FMU; the callbacks write here, so their place does not change.
    messages: Box<Messages>,
    /// Read by the FMU as long as it lives.
    _callbacks: Box<Callbacks>,
    library: Library,
}

fn note(environment: *mut c_void, message: *const c_char) {
    if environment.is_null() || message.is_null() {
        return;
    }
    // SAFETY: the environment is that of `Instance`, which lives longer than its FMU; a message ends with 0.
    let (messages, text) = unsafe { (&*environment.cast::<Messages>(), CStr::from_ptr(message)) };
    if let Ok(mut messages) = messages.lock()
        && messages.len() < 100
    {
        messages.push(text.to_string_lossy().trim().to_owned());
    }
}

/// The logger of FMI 2.0 has arguments for its format behind these. The first of them is taken where the
/// format is that of a text alone; others are left as the format has them.
unsafe extern "C" fn log2(
    environment: *mut c_void,
    _: *const c_char,
    _: c_int,
    _: *const c_char,
    format: *const c_char,
    first: *const c_char,
) {
    // SAFETY: a format ends with 0.
    let is_text = !format.is_null() && unsafe { CStr::from_ptr(format) }.to_bytes() == b"%s";
    // On this machine arguments behind a format stand where others do, except with Apple on ARM.
    let apart = cfg!(all(target_vendor = "apple", target_arch = "aarch64"));
    note(environment, if is_text && !apart { first } else { format });
}

unsafe extern "C" fn log3(environment: *mut c_void, _: c_int, _: *const c_char, message: *const c_char) {
    note(environment, message);
}

unsafe extern "C" fn allocate(count: usize, size: usize) -> *mut c_void {
    // SAFETY: any two numbers are allowed.
    unsafe { libc::calloc(count, size) }
}

unsafe extern "C" fn free(memory: *mut c_void) {
    // SAFETY: an FMU frees what `allocate` gave it.
    unsafe { libc::free(memory) };
}

impl Instance {
    /// Loads the library and makes an instance of it. This runs code of the FMU.
    ///
    /// # Errors
    ///
    /// The library cannot be loaded, or it makes no instance; with what it said.
    pub fn new(library: &Path, resources: &Path, what: &Description) -> Result<Instance, String> {
        // SAFETY: loading runs code of the FMU, which the user has chosen to trust.
        let library = unsafe { Library::new(library) }.map_err(|e| format!("it cannot be loaded: {e}"))?;
        let messages: Box<Messages> = Box::default();
        let environment = (&raw const *messages).cast_mut().cast::<c_void>();
        let callbacks = Box::new(Callbacks { logger: log2, allocate, free, finished: None, environment });
        let (handle, version) = (std::ptr::null_mut(), what.version);
        let mut instance = Instance { version, handle, messages, _callbacks: callbacks, library };
        instance.handle = instance.instantiate(resources, what, environment)?;
        if instance.handle.is_null() {
            return Err(instance.said("it makes no instance"));
        }
        Ok(instance)
    }

    fn instantiate(
        &self,
        resources: &Path,
        what: &Description,
        environment: *mut c_void,
    ) -> Result<Handle, String> {
        let text = |s: &str| CString::new(s).map_err(|_| "a name with a zero".to_owned());
        let (name, token) = (text("plant")?, text(&what.token)?);
        let path = resources.display();
        if self.version == Version::V2 {
            type Instantiate = unsafe extern "C" fn(
                *const c_char,
                c_int,
                *const c_char,
                *const c_char,
                *const Callbacks,
                c_int,
                c_int,
            ) -> Handle;
            let place = text(&format!("file://{}{path}", if cfg!(windows) { "/" } else { "" }))?;
            let make = self.function::<Instantiate>("fmi2Instantiate")?;
            // SAFETY: the types are those of the standard, and the callbacks live as long as the instance.
            return Ok(unsafe {
                make(name.as_ptr(), 1, token.as_ptr(), place.as_ptr(), &raw const *self._callbacks, 0, 0)
            });
        }
        type Instantiate = unsafe extern "C" fn(
            *const c_char,
            *const c_char,
            *const c_char,
            bool,
            bool,
            bool,
            bool,
            References,
            usize,
            *mut c_void,
            unsafe extern "C" fn(*mut c_void, c_int, *const c_char, *const c_char),
            *const c_void,
        ) -> Handle;
        let place = text(&format!("{path}{}", std::path::MAIN_SEPARATOR))?;
        let make = self.function::<Instantiate>("fmi3InstantiateCoSimulation")?;
        let null = std::ptr::null();
        // SAFETY: as above.
        Ok(unsafe {
            make(
                name.as_ptr(),
                token.as_ptr(),
                place.as_ptr(),
                false,
                false,
                false,
                false,
                std::ptr::null(),
                0,
                environment,
                log3,
                null,
            )
        })
    }

    /// A function by its name.
    fn function<F: Copy>(&self, name: &str) -> Result<F, String> {
        // SAFETY: each caller names the type that the standard gives this function.
        let found = unsafe { self.library.get::<F>(name.as_bytes()) };
        found.map(|f| *f).map_err(|_| format!("its library has no `{name}`"))
    }

    /// A sentence with what the FMU said since the last one.
    fn said(&self, what: &str) -> String {
        let messages = self.messages.lock().map(|mut m| std::mem::take(&mut *m)).unwrap_or_default();
        if messages.is_empty() { what.to_owned() } else { format!("{what}: {}", messages.join("; ")) }
    }

    /// Judges a status: 0 and 1 (a warning) are fine.
    fn judge(&self, status: c_int, function: &str) -> Result<(), String> {
        match status {
            0 | 1 => Ok(()),
            2 => Err(self.said(&format!("`{function}` was discarded"))),
            _ => Err(self.said(&format!("`{function}` failed"))),
        }
    }

    fn plain(&self, function: &str) -> Result<(), String> {
        let call = self.function::<unsafe extern "C" fn(Handle) -> c_int>(function)?;
        // SAFETY: the handle is an instance that lives.
        self.judge(unsafe { call(self.handle) }, function)
    }

    /// Begins the initialization at 0 s; inputs may be set then.
    ///
    /// # Errors
    ///
    /// The FMU refuses.
    pub fn begin(&self) -> Result<(), String> {
        if self.version == Version::V2 {
            type Setup = unsafe extern "C" fn(Handle, c_int, f64, f64, c_int, f64) -> c_int;
            let call = self.function::<Setup>("fmi2SetupExperiment")?;
            // SAFETY: the handle is an instance that lives.
            self.judge(unsafe { call(self.handle, 0, 0.0, 0.0, 0, 0.0) }, "fmi2SetupExperiment")?;
            return self.plain("fmi2EnterInitializationMode");
        }
        type Enter = unsafe extern "C" fn(Handle, bool, f64, f64, bool, f64) -> c_int;
        let call = self.function::<Enter>("fmi3EnterInitializationMode")?;
        // SAFETY: the handle is an instance that lives.
        self.judge(unsafe { call(self.handle, false, 0.0, 0.0, false, 0.0) }, "fmi3EnterInitializationMode")
    }

    /// Ends the initialization.
    ///
    /// # Errors
    ///
    /// The FMU refuses.
    pub fn ready(&self) -> Result<(), String> {
        self.plain(match self.version {
            Version::V2 => "fmi2ExitInitializationMode",
            Version::V3 => "fmi3ExitInitializationMode",
        })
    }

    /// A step of `size` seconds. True if the FMU wants to end the simulation.
    ///
    /// # Errors
    ///
    /// The FMU cannot make it.
    pub fn step(&self, from: f64, size: f64) -> Result<bool, String> {
        if self.version == Version::V2 {
            type Step = unsafe extern "C" fn(Handle, f64, f64, c_int) -> c_int;
            let call = self.function::<Step>("fmi2DoStep")?;
            // SAFETY: the handle is an instance that lives.
            self.judge(unsafe { call(self.handle, from, size, 1) }, "fmi2DoStep")?;
            return Ok(false);
        }
        type Step =
            unsafe extern "C" fn(Handle, f64, f64, bool, *mut bool, *mut bool, *mut bool, *mut f64) -> c_int;
        let call = self.function::<Step>("fmi3DoStep")?;
        let (mut event, mut end, mut early, mut reached) = (false, false, false, 0.0);
        // SAFETY: the handle is an instance that lives, and the FMU writes into these four.
        let status = unsafe {
            call(
                self.handle,
                from,
                size,
                true,
                &raw mut event,
                &raw mut end,
                &raw mut early,
                &raw mut reached,
            )
        };
        self.judge(status, "fmi3DoStep")?;
        Ok(end)
    }

    /// Calls a getter or setter with room for one value.
    fn exchange<T>(&self, function: &str, v: &Variable, value: &mut T) -> Result<(), String> {
        let (which, to) = (&raw const v.reference, &raw mut *value);
        let status = match self.version {
            Version::V2 => {
                let call = self.function::<Values2<T>>(function)?;
                // SAFETY: one reference and one value of the type of the function.
                unsafe { call(self.handle, which, 1, to) }
            }
            Version::V3 => {
                let call = self.function::<Values3<T>>(function)?;
                // SAFETY: as above; the value has one element.
                unsafe { call(self.handle, which, 1, to, 1) }
            }
        };
        self.judge(status, function).map_err(|e| format!("`{}`: {e}", v.name))
    }

    /// The function of a type: `fmi3GetInt16`.
    fn name_of(&self, verb: &str, ty: Type) -> String {
        let two = self.version == Version::V2;
        let word = match ty {
            Type::Boolean => "Boolean".to_owned(),
            Type::Double if two => "Real".to_owned(),
            Type::Double => "Float64".to_owned(),
            Type::Single => "Float32".to_owned(),
            Type::Int { .. } if two => "Integer".to_owned(),
            Type::Int { bits, signed } => format!("{}Int{bits}", if signed { "" } else { "U" }),
            Type::String | Type::Other => "String".to_owned(),
        };
        format!("fmi{}{verb}{word}", if two { 2 } else { 3 })
    }

    /// The value of a variable.
    ///
    /// # Errors
    ///
    /// The FMU does not give it.
    pub fn get(&self, v: &Variable) -> Result<Value, String> {
        let name = self.name_of("Get", v.ty);
        let int = |value: i128| Ok(Value::Int(value));
        macro_rules! take {
            ($ty:ty) => {{
                let mut value = <$ty>::default();
                self.exchange(&name, v, &mut value)?;
                value
            }};
        }
        match v.ty {
            Type::Boolean if self.version == Version::V2 => Ok(Value::Bool(take!(c_int) != 0)),
            // As a byte: a wrong FMU may write another than 0 and 1.
            Type::Boolean => Ok(Value::Bool(take!(u8) != 0)),
            Type::Double => Ok(Value::Real(take!(f64))),
            Type::Single => Ok(Value::Real(take!(f32).into())),
            Type::Int { bits: 8, signed: true } => int(take!(i8).into()),
            Type::Int { bits: 16, signed: true } => int(take!(i16).into()),
            Type::Int { bits: 32, signed: true } => int(take!(i32).into()),
            Type::Int { signed: true, .. } => int(take!(i64).into()),
            Type::Int { bits: 8, .. } => int(take!(u8).into()),
            Type::Int { bits: 16, .. } => int(take!(u16).into()),
            Type::Int { bits: 32, .. } => int(take!(u32).into()),
            Type::Int { .. } => int(take!(u64).into()),
            Type::String => {
                let mut text: *const c_char = std::ptr::null();
                self.exchange(&name, v, &mut text)?;
                if text.is_null() {
                    return Ok(Value::Text(String::new()));
                }
                // SAFETY: a text of an FMU ends with 0 and stays until the next call.
                Ok(Value::Text(unsafe { CStr::from_ptr(text) }.to_string_lossy().into_owned()))
            }
            Type::Other => Err(format!("`{}` is an array, binary or a clock", v.name)),
        }
    }

    /// Sets a variable.
    ///
    /// # Errors
    ///
    /// The value is of another type or beyond it, or the FMU refuses it.
    pub fn set(&self, v: &Variable, value: &Value) -> Result<(), String> {
        let name = self.name_of("Set", v.ty);
        let wrong = || format!("`{}` cannot hold {value:?}", v.name);
        macro_rules! give {
            ($ty:ty, $n:expr) => {{
                let mut number = <$ty>::try_from(*$n).map_err(|_| wrong())?;
                self.exchange(&name, v, &mut number)
            }};
        }
        match (v.ty, value) {
            (Type::Boolean, Value::Bool(b)) if self.version == Version::V2 => {
                self.exchange(&name, v, &mut c_int::from(*b))
            }
            (Type::Boolean, Value::Bool(b)) => self.exchange(&name, v, &mut u8::from(*b)),
            (Type::Double, Value::Real(r)) => self.exchange(&name, v, &mut { *r }),
            (Type::Single, Value::Real(r)) => self.exchange(&name, v, &mut { *r as f32 }),
            (Type::Int { bits: 8, signed: true }, Value::Int(n)) => give!(i8, n),
            (Type::Int { bits: 16, signed: true }, Value::Int(n)) => give!(i16, n),
            (Type::Int { bits: 32, signed: true }, Value::Int(n)) => give!(i32, n),
            (Type::Int { signed: true, .. }, Value::Int(n)) => give!(i64, n),
            (Type::Int { bits: 8, .. }, Value::Int(n)) => give!(u8, n),
            (Type::Int { bits: 16, .. }, Value::Int(n)) => give!(u16, n),
            (Type::Int { bits: 32, .. }, Value::Int(n)) => give!(u32, n),
            (Type::Int { .. }, Value::Int(n)) => give!(u64, n),
            (Type::String, Value::Text(t)) => {
                let text = CString::new(t.as_str()).map_err(|_| wrong())?;
                self.exchange(&name, v, &mut text.as_ptr())
            }
            _ => Err(wrong()),
        }
    }
}

impl Drop for Instance {
    fn drop(&mut self) {
        let name = match self.version {
            Version::V2 => "fmi2FreeInstance",
            Version::V3 => "fmi3FreeInstance",
        };
        if let (false, Ok(free)) =
            (self.handle.is_null(), self.function::<unsafe extern "C" fn(Handle)>(name))
        {
            // SAFETY: the instance is not used after this.
            unsafe { free(self.handle) };
        }
    }
}
