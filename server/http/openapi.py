#!/usr/bin/env python3
"""Writes openapi.yaml, whose head explains its short forms, as JSON into a C++ header.

usage: openapi.py openapi.yaml openapi_text.hpp
"""

import json
import pathlib
import sys

import yaml

HEADER = """#pragma once

#include <string_view>

namespace scanloom::http {{

/// openapi.yaml as JSON, with its short forms expanded.
inline constexpr std::string_view kOpenapiText = R"openapi({})openapi";

}} // namespace scanloom::http
"""
SIMPLE_TYPES = ("string", "number", "integer", "boolean", "array", "object")
CACHE_HEADERS = {
    "ETag": "Strong entity tag, for If-None-Match.",
    "Cache-Control": "How long a client may cache the response.",
}


def reference(kind, name):
    return {"$ref": f"#/components/{kind}/{name}"}


def split(text):
    """Splits "TYPE - Description."."""
    kind, _, description = text.partition(" - ")
    return {"type": kind, "description": description} if description else {"type": kind}


class Expander:
    def __init__(self, source):
        self.types = {name: {"type": name} for name in SIMPLE_TYPES} | source["types"]
        self.schemas = source["components"]["schemas"]
        self.responses = source["components"]["responses"]
        self.statuses = source["statuses"]

    def type(self, name):
        if name.endswith("?"):
            schema = self.type(name[:-1])
            return ({"type": "object", "allOf": [schema]} if "$ref" in schema else schema) | {"nullable": True}
        if name.endswith("[]"):
            return {"type": "array", "items": self.type(name[:-2])}
        return reference("schemas", name) if name in self.schemas else self.types[name]

    def schema(self, short):
        schema = split(short) if isinstance(short, str) else dict(short)
        implied = "object" if "properties" in schema else "string" if "enum" in schema else None
        kind = schema.pop("type", implied)
        if "properties" in schema:
            members = schema["properties"]
            schema["properties"] = {name.rstrip("?"): self.schema(member) for name, member in members.items()}
            required = [name for name in members if not name.endswith("?")]
            if required:
                schema["required"] = required
        for several in {"oneOf", "allOf"} & schema.keys():
            schema[several] = [self.schema(one) for one in schema[several]]
        for inner in {"items", "additionalProperties"} & schema.keys():
            schema[inner] = schema[inner] and self.schema(schema[inner])
        return (self.type(kind) if kind else {}) | schema

    def parameter(self, component, short):
        schema = split(short) if isinstance(short, str) else dict(short)
        place = schema.pop("in", "query")
        parameter = {
            "name": schema.pop("name", component),
            "in": place,
            "required": schema.pop("required", place == "path"),
            "description": schema.pop("description"),
            "schema": self.schema(schema),
        }
        is_list = parameter["schema"].get("type") == "array"
        return parameter | ({"style": "form", "explode": False} if is_list else {})

    def content(self, short):
        return {media: {"schema": self.schema(schema)} for media, schema in short.items() if "/" in media}

    def response(self, short, is_cached=False):
        if isinstance(short, str):
            return reference("responses", short) if short in self.responses else {"description": short}
        response = {"description": short["description"]}
        headers = (CACHE_HEADERS if is_cached else {}) | short.get("headers", {})
        if headers:
            response["headers"] = {
                name: {"description": description, "schema": {"type": "string"}}
                for name, description in headers.items()
            }
        content = self.content(short)
        return response | ({"content": content} if content else {})

    def problem(self, short):
        is_text = isinstance(short, str)
        return self.response({"description": short, "application/problem+json": "Problem"} if is_text else short)

    def operation(self, short):
        operation = {"summary": short["summary"], "tags": [short["tag"]]}
        operation |= {key: short[key] for key in ("description", "security", "parameters") if key in short}
        if "body" in short:
            body = short["body"]
            is_form = isinstance(body, dict) and "multipart/form-data" in body
            content = self.content(body if is_form else {"application/json": body})
            operation["requestBody"] = {"required": True, "content": content}
        also = short.get("also", [])
        responses = {status: self.response(self.statuses[status]) for status in also}
        for status in (key for key in short if isinstance(key, int)):
            responses[status] = self.response(short[status], is_cached=status == 200 and 304 in also)
        return operation | {"responses": {str(status): responses[status] for status in sorted(responses)}}


def expanded(source):
    """Returns the document without paths and settings, the operations by name, and the usual response of each status."""
    expander = Expander(source)
    components = dict(source["components"])
    components["parameters"] = {name: expander.parameter(name, one) for name, one in components["parameters"].items()}
    components["responses"] = {name: expander.problem(one) for name, one in components["responses"].items()}
    components["schemas"] = {name: expander.schema(one) for name, one in components["schemas"].items()}
    document = {key: value for key, value in source.items() if key not in ("types", "statuses", "operations")}
    return {
        "document": document | {"components": components},
        "operations": {name: expander.operation(one) for name, one in source["operations"].items()},
        "statuses": {str(status): reference("responses", name) for status, name in source["statuses"].items()},
    }


if __name__ == "__main__":
    with open(sys.argv[1], encoding="utf-8") as file:
        text = json.dumps(expanded(yaml.safe_load(file)), ensure_ascii=False)
    header, path = HEADER.format(text), pathlib.Path(sys.argv[2])
    if not path.exists() or path.read_text(encoding="utf-8") != header:  # else nothing is compiled again
        path.write_text(header, encoding="utf-8")
