"""Calls of C functions at an address from compiled code."""

from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic


@intrinsic
def _c_call(typing_context: Any, address: Any, arguments: Any) -> Any:
    """Call the C function without result at an address, with integers or pointers."""
    signature = types.void(address, arguments)

    def build(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        kinds = signature.args[1]
        unpacked = cgutils.unpack_tuple(  # type: ignore[no-untyped-call]
            builder, values[1], len(kinds)
        )
        words = [context.get_value_type(kind) for kind in kinds]
        pointer = ir.FunctionType(ir.VoidType(), words).as_pointer()
        builder.call(builder.inttoptr(values[0], pointer), unpacked)
        return context.get_dummy_value()

    return signature, build


# numba passes the typing context itself.
call: Any = _c_call
