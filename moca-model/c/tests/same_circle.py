"""Check that the circle of C++ ends bit for bit where that of Rust does: same_circle.py CPP URDF RUST."""

import ast
import subprocess
import sys

cpp, urdf, rust = sys.argv[1:]
in_cpp = subprocess.run([cpp, urdf], check=True, capture_output=True, text=True).stdout.split()
in_rust = subprocess.run([rust], check=True, capture_output=True, text=True).stdout
in_cpp, in_rust = [float.fromhex(joint) for joint in in_cpp], ast.literal_eval(in_rust)
sys.exit(None if in_cpp == in_rust and len(in_rust) == 7 else f"C++ {in_cpp}\nRust {in_rust}")
