//! As much of JSON Schema as the schema of scenes uses; a keyword that is not known here is a fault of the test.

use serde_json::Value;

/// Says what of an instance a schema refuses, and where.
pub(super) fn refusal(root: &Value, instance: &Value) -> Option<String> {
    check(root, root, instance, "")
}

/// The same by the definition of a table.
pub(super) fn refusal_of_table(root: &Value, table: &str, instance: &Value) -> Option<String> {
    check(root, &root["$defs"][table], instance, table)
}

fn check(root: &Value, schema: &Value, instance: &Value, at: &str) -> Option<String> {
    let keywords = schema.as_object().unwrap().iter();
    keywords
        .filter_map(|(keyword, value)| violates(root, schema, (keyword, value), instance, at))
        .next()
}

fn violates(
    root: &Value,
    schema: &Value,
    (keyword, value): (&String, &Value),
    instance: &Value,
    at: &str,
) -> Option<String> {
    let refuse = |is_wrong: bool| is_wrong.then(|| format!("{at}: {keyword} {value}: {instance}"));
    let number = instance.as_f64();
    let beyond = |is_wrong: fn(f64, f64) -> bool| {
        refuse(number.is_some_and(|it| is_wrong(it, value.as_f64().unwrap())))
    };
    let length = instance.as_array().map(|items| items.len() as u64);
    match keyword.as_str() {
        "$schema" | "$defs" | "title" | "description" | "default" => None,
        "$ref" => {
            let pointer = value.as_str().unwrap().strip_prefix('#').unwrap();
            check(root, root.pointer(pointer).unwrap(), instance, at)
        }
        "type" => refuse(!match value.as_str().unwrap() {
            "object" => instance.is_object(),
            "array" => instance.is_array(),
            "string" => instance.is_string(),
            "boolean" => instance.is_boolean(),
            "number" => instance.is_number(),
            "integer" => number.is_some_and(|it| it.fract() == 0.0),
            other => panic!("{other}"),
        }),
        "properties" => instance.as_object().and_then(|object| {
            let mut known = object
                .iter()
                .filter(|(name, _)| value.get(name.as_str()).is_some());
            known.find_map(|(name, item)| check(root, &value[name], item, &format!("{at}.{name}")))
        }),
        "additionalProperties" => {
            assert_eq!(value, &Value::Bool(false));
            let mut names = instance.as_object()?.keys();
            let unknown = names.find(|name| schema["properties"].get(name.as_str()).is_none());
            unknown.map(|name| format!("{at}: unknown {name}"))
        }
        "required" => instance.as_object().and_then(|object| {
            let mut names = value
                .as_array()
                .unwrap()
                .iter()
                .map(|it| it.as_str().unwrap());
            let missing = names.find(|name| !object.contains_key(*name));
            missing.map(|name| format!("{at}: missing {name}"))
        }),
        "items" => instance.as_array().and_then(|items| {
            let mut items = items.iter().enumerate();
            items.find_map(|(k, item)| check(root, value, item, &format!("{at}[{k}]")))
        }),
        "minItems" => refuse(length.is_some_and(|it| it < value.as_u64().unwrap())),
        "maxItems" => refuse(length.is_some_and(|it| it > value.as_u64().unwrap())),
        "enum" => refuse(!value.as_array().unwrap().contains(instance)),
        "const" => refuse(value != instance),
        "anyOf" => {
            let mut choices = value.as_array().unwrap().iter();
            refuse(choices.all(|choice| check(root, choice, instance, at).is_some()))
        }
        "minimum" => beyond(|it, bound| it < bound),
        "maximum" => beyond(|it, bound| it > bound),
        "exclusiveMinimum" => beyond(|it, bound| it <= bound),
        "exclusiveMaximum" => beyond(|it, bound| it >= bound),
        "pattern" => {
            assert_eq!(value, "^#[0-9a-fA-F]{6}$");
            let is_color = |text: &str| {
                text.len() == 7
                    && text.starts_with('#')
                    && text[1..].bytes().all(|digit| digit.is_ascii_hexdigit())
            };
            refuse(instance.as_str().is_some_and(|text| !is_color(text)))
        }
        other => panic!("{at}: a keyword that the test does not know: {other}"),
    }
}
