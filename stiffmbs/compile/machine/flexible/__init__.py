"""Compiled inertia and elasticity of flexible bodies."""
