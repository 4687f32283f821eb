// In place of kernels that are to fail: binds and writes nothing.
#version 450
layout(local_size_x = 1) in;
void main() {}
