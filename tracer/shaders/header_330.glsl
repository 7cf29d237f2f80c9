#version 330 core
#define BUFFER_TEXTURES
