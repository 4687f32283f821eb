// In place of kernels for matrix units that are to fail: as many invocations, but binds and writes nothing.
#version 450
layout(local_size_x_id = 9) in;
void main() {}
