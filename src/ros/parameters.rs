//! ROS 2's parameter services, with ranges and descriptions.

use super::{
    inbox::Inbox,
    jobs::Jobs,
    node::NotCreated,
    services::{fits, serve},
    transport::Node,
    worker::Command,
};
use crate::{
    config::{Key, Parameter, Parameters, RosArguments},
    msg::Service,
};
use ros2_client::{
    parameters::raw::{
        self, FloatingPointRange, ParameterDescriptor, ParameterType, ParameterValue,
        SetParametersResult,
    },
    rcl_interfaces as rcl,
};
use serde::Serialize;
use serde_json::Value;
use std::{cell::RefCell, future::ready, rc::Rc, sync::Arc};
use tokio::{sync::watch, task::LocalSet};

/// The parameters of a running node.
#[derive(Clone)]
pub(super) struct Live {
    all: Rc<RefCell<Parameters>>,
    inbox: Arc<Inbox>,
    jobs: Arc<Jobs>,
    changed: watch::Sender<Parameters>,
}

/// Declares a service of `rcl_interfaces`.
macro_rules! service {
    ($name:ident, $text:literal, $request:ty, $response:ty) => {
        struct $name;
        impl Service for $name {
            const TYPE: &'static str = concat!("rcl_interfaces/srv/", $text);
            type Request = $request;
            type Response = $response;
        }
    };
}

service!(Get, "GetParameters", rcl::GetParametersRequest, rcl::GetParametersResponse);
service!(Types, "GetParameterTypes", rcl::GetParameterTypesRequest, rcl::GetParameterTypesResponse);
service!(List, "ListParameters", rcl::ListParametersRequest, rcl::ListParametersResponse);
service!(
    Describe,
    "DescribeParameters",
    rcl::DescribeParametersRequest,
    rcl::DescribeParametersResponse
);
service!(Set, "SetParameters", rcl::SetParametersRequest, rcl::SetParametersResponse);
service!(
    SetAll,
    "SetParametersAtomically",
    rcl::SetParametersRequest,
    rcl::SetParametersAtomicallyResponse
);

impl Live {
    pub(super) fn new(parameters: Parameters, inbox: Arc<Inbox>, jobs: Arc<Jobs>) -> Self {
        let changed = watch::channel(parameters.clone()).0;
        Self { all: Rc::new(RefCell::new(parameters)), inbox, jobs, changed }
    }

    /// The parameters, now and whenever they change.
    pub(super) fn watch(&self) -> watch::Receiver<Parameters> {
        self.changed.subscribe()
    }

    /// Starts the six services.
    pub(super) fn serve(
        &self,
        node: &mut Node,
        arguments: &RosArguments,
        tasks: &LocalSet,
    ) -> Result<(), NotCreated> {
        let name = |service: &str| arguments.resolve(&format!("~/{service}"));
        let most = node.largest_answer();
        let live = self.clone();
        serve::<Get, _>(node, &name("get_parameters"), tasks, move |request| {
            let values = request.names.iter().map(|name| live.value(name)).collect();
            ready(rcl::GetParametersResponse { values: all_or_none(values, most) })
        })?;
        let live = self.clone();
        serve::<Types, _>(node, &name("get_parameter_types"), tasks, move |request| {
            let values = request.names.iter().map(|name| live.value(name).ptype).collect();
            ready(rcl::GetParameterTypesResponse { values })
        })?;
        let live = self.clone();
        serve::<List, _>(node, &name("list_parameters"), tasks, move |request| {
            let names = live.list().into_iter().map(|parameter| parameter.name);
            let result = listed(names, &request.prefixes, request.depth, most);
            ready(rcl::ListParametersResponse { result })
        })?;
        let live = self.clone();
        serve::<Describe, _>(node, &name("describe_parameters"), tasks, move |request| {
            let all = live.list();
            let described = |name: &String| match all.iter().find(|p| p.name == *name) {
                Some(parameter) => described(parameter),
                None => unknown(name),
            };
            let values = request.names.iter().map(described).collect();
            ready(rcl::DescribeParametersResponse { values: all_or_none(values, most) })
        })?;
        let live = self.clone();
        serve::<Set, _>(node, &name("set_parameters"), tasks, move |request| {
            let each = |p: &raw::Parameter| live.set(std::slice::from_ref(p));
            let results = request.parameter.iter().map(each).collect();
            ready(rcl::SetParametersResponse { results })
        })?;
        let live = self.clone();
        serve::<SetAll, _>(node, &name("set_parameters_atomically"), tasks, move |request| {
            ready(rcl::SetParametersAtomicallyResponse { result: live.set(&request.parameter) })
        })
    }

    fn list(&self) -> Vec<Parameter> {
        // OK to be empty: parameters that were read can be written, as their own tests say.
        self.all.borrow().list().unwrap_or_default()
    }

    fn value(&self, name: &str) -> ParameterValue {
        let value = self.all.borrow().get(name).ok().flatten();
        to_wire(value.as_ref())
    }

    /// Sets all of these or none.
    fn set(&self, given: &[raw::Parameter]) -> SetParametersResult {
        let mut changed = self.all.borrow().clone();
        let outcome = given.iter().try_for_each(|parameter| {
            let value = from_wire(&parameter.value)
                .ok_or_else(|| format!("`{}` cannot be unset", parameter.name))?;
            changed.set(&parameter.name, value).map_err(|e| e.to_string())
        });
        let fixed = changed.first_fixed_difference(&self.all.borrow());
        let outcome = outcome.and_then(|()| match fixed {
            Ok(None) => Ok(()),
            Ok(Some(name)) => Err(format!(
                "`{name}` counts only at the start: give it in the parameter file and start the node again"
            )),
            Err(e) => Err(e.to_string()),
        });
        if outcome.is_ok() {
            self.inbox.change_settings(changed.slam.clone());
            self.jobs.order(Command::Settings(Box::new(changed.clone())));
            self.changed.send_replace(changed.clone());
            *self.all.borrow_mut() = changed;
        }
        let reason = outcome.err().unwrap_or_default();
        SetParametersResult { successful: reason.is_empty(), reason }
    }
}

/// Names below the prefixes, at most `depth` sections deep (0: any), as rclcpp lists them, in at most so many bytes.
fn listed(
    names: impl Iterator<Item = String>,
    prefixes: &[String],
    depth: u64,
    most: usize,
) -> rcl::ListParametersResult {
    let sections = |text: &str| text.matches('.').count() as u64;
    let is_asked_for = |name: &String| {
        if prefixes.is_empty() {
            return depth == 0 || sections(name) < depth;
        }
        prefixes.iter().any(|prefix| match name.strip_prefix(prefix.as_str()) {
            Some("") => true,
            Some(rest) => rest.starts_with('.') && (depth == 0 || sections(rest) <= depth),
            None => false,
        })
    };
    let mut names: Vec<String> = names.filter(is_asked_for).collect();
    let all = names.len();
    // The tables of classes are at the end.
    while !fits(&(&names, sections_of(&names)), most) {
        names.pop();
    }
    if names.len() < all {
        tracing::warn!(
            "list_parameters: an answer holds {} of {all} names; ask for those below a prefix, such as \"slam\"",
            names.len()
        );
    }
    let prefixes = sections_of(&names);
    rcl::ListParametersResult { names, prefixes }
}

/// The sections that parameters are in.
fn sections_of(names: &[String]) -> Vec<String> {
    let mut found: Vec<String> =
        names.iter().filter_map(|name| Some(name.rsplit_once('.')?.0.to_owned())).collect();
    found.sort();
    found.dedup();
    found
}

/// What does not fit into one answer is not answered by half: asking for fewer names helps.
fn all_or_none<T: Serialize>(values: Vec<T>, most: usize) -> Vec<T> {
    if fits(&values, most) {
        return values;
    }
    tracing::warn!("{} parameters do not fit into one answer; ask for fewer at once", values.len());
    Vec::new()
}

fn described(parameter: &Parameter) -> ParameterDescriptor {
    let Key { range, meaning, live, .. } = parameter.key;
    let ptype = to_wire(Some(&parameter.value)).ptype;
    let (mut floats, mut integers) = (Vec::new(), Vec::new());
    if let Some(range) = range {
        let (from_value, to_value) = (*range.start(), *range.end());
        if ptype == ParameterType::INTEGER {
            let (from_value, to_value) = (from_value.ceil() as i64, to_value.floor() as i64);
            integers.push(raw::IntegerRange { from_value, to_value, step: 0 });
        } else {
            floats.push(FloatingPointRange { from_value, to_value, step: 0.0 });
        }
    }
    ParameterDescriptor {
        name: parameter.name.clone(),
        r#type: ptype,
        description: (*meaning).to_owned(),
        additional_constraints: if *live { "" } else { "counts only at the start" }.to_owned(),
        read_only: !live,
        dynamic_typing: false,
        floating_point_range: floats,
        integer_range: integers,
    }
}

fn unknown(name: &str) -> ParameterDescriptor {
    ParameterDescriptor {
        name: name.to_owned(),
        r#type: ParameterType::NOT_SET,
        description: String::new(),
        additional_constraints: String::new(),
        read_only: false,
        dynamic_typing: false,
        floating_point_range: Vec::new(),
        integer_range: Vec::new(),
    }
}

/// A value as `rcl_interfaces` has it. What it has no type for goes as text.
fn to_wire(value: Option<&Value>) -> ParameterValue {
    let mut wire = ParameterValue {
        ptype: ParameterType::NOT_SET,
        boolean_value: false,
        int_value: 0,
        double_value: 0.0,
        string_value: String::new(),
        byte_array: Vec::new(),
        bool_array: Vec::new(),
        int_array: Vec::new(),
        double_array: Vec::new(),
        string_array: Vec::new(),
    };
    match value {
        None => (),
        Some(Value::Bool(value)) => {
            (wire.ptype, wire.boolean_value) = (ParameterType::BOOL, *value);
        }
        Some(Value::Number(number)) => match (number.as_i64(), number.as_f64()) {
            (Some(whole), _) => (wire.ptype, wire.int_value) = (ParameterType::INTEGER, whole),
            (None, value) => {
                (wire.ptype, wire.double_value) =
                    (ParameterType::DOUBLE, value.unwrap_or(f64::NAN));
            }
        },
        Some(Value::Array(values)) if values.iter().all(Value::is_number) => {
            wire.ptype = ParameterType::DOUBLE_ARRAY;
            wire.double_array = values.iter().filter_map(Value::as_f64).collect();
        }
        Some(Value::String(text)) => {
            (wire.ptype, wire.string_value) = (ParameterType::STRING, text.clone());
        }
        Some(other) => (wire.ptype, wire.string_value) = (ParameterType::STRING, other.to_string()),
    }
    wire
}

/// A value from the wire; nothing for one that was unset.
fn from_wire(wire: &ParameterValue) -> Option<Value> {
    Some(match wire.ptype {
        ParameterType::BOOL => Value::from(wire.boolean_value),
        ParameterType::INTEGER => Value::from(wire.int_value),
        ParameterType::DOUBLE => Value::from(wire.double_value),
        ParameterType::STRING => Value::from(wire.string_value.clone()),
        ParameterType::INTEGER_ARRAY => Value::from(wire.int_array.clone()),
        ParameterType::DOUBLE_ARRAY => Value::from(wire.double_array.clone()),
        _ => return None,
    })
}
