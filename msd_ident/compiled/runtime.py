"""What compiled code asks for while it runs, as part of it: memory for arrays; and nothing of Python.

Arrays that compiled code makes stand behind a header of numba's runtime (numba/core/runtime/nrt.cpp, ``MemInfo``):
count of references, destructor and what it is given, address of the data, its size, and who else owns it.
"""

from __future__ import annotations

import re
from typing import Any

import llvmlite.binding as llvm

#: Bytes of the header.
_HEADER = 48

_MEMORY = f"""
declare ptr @malloc(i64)
declare void @free(ptr)

define ptr @NRT_MemInfo_alloc_aligned(i64 %size, i32 %align) {{
  %step = zext i32 %align to i64
  %room = add i64 %size, %step
  %whole = add i64 %room, {_HEADER}
  %header = call ptr @malloc(i64 %whole)
  %none = icmp eq ptr %header, null
  br i1 %none, label %done, label %fill
fill:
  call void @llvm.memset.p0.i64(ptr %header, i8 0, i64 {_HEADER}, i1 false)
  store i64 1, ptr %header
  %start = ptrtoint ptr %header to i64
  %after = add i64 %start, {_HEADER - 1}
  %upper = add i64 %after, %step
  %rest = urem i64 %upper, %step
  %data = sub i64 %upper, %rest
  %place = getelementptr i8, ptr %header, i64 24
  store i64 %data, ptr %place
  %length = getelementptr i8, ptr %header, i64 32
  store i64 %size, ptr %length
  br label %done
done:
  ret ptr %header
}}

define void @NRT_MemInfo_call_dtor(ptr %header) {{
  call void @free(ptr %header)
  ret void
}}

declare void @llvm.memset.p0.i64(ptr, i8, i64, i1)
"""
#: What code asks of Python and of numba's runtime where it fails.
_LEFT_OUT = re.compile("_?Py|NRT_Free$|numba_(gil_ensure|gil_release|unpickle|do_raise|runtime_build_excinfo_struct)$")


def memory() -> Any:
    """A module with what arrays need.

    Raises:
        RuntimeError: a version of LLVM that cannot read it.
    """
    return llvm.parse_assembly(_MEMORY)


def self_contained(module: Any) -> bytes:
    """Object code of a module, with functions that do nothing in place of Python's."""
    module.link_in(llvm.parse_assembly("\n".join(_without_python(module))))
    machine = llvm.Target.from_default_triple().create_target_machine(
        cpu=llvm.get_host_cpu_name(), features=llvm.get_host_cpu_features().flatten(), opt=3, reloc="pic", jit=True
    )
    return bytes(machine.emit_object(module))


def _without_python(module: Any) -> list[str]:
    """Definitions, as source, of what the module only declares."""
    lines = []
    for function in module.functions:
        if function.is_declaration and _LEFT_OUT.match(function.name):
            declared = re.match(r"declare (?:noalias )?(\S+) @\S+?\((.*?)\)", str(function).strip())
            assert declared is not None
            result, taken = declared.groups()
            taken = ", ".join(word.split()[0] for word in taken.split(",") if word)
            nothing = {"void": "ret void", "ptr": "ret ptr null"}.get(result, f"ret {result} 0")
            lines.append(f"define {result} @{function.name}({taken}) {{ {nothing} }}")
    for value in module.global_variables:
        if value.is_declaration and _LEFT_OUT.match(value.name):
            lines.append(f"@{value.name} = global i8 0")
    return lines
