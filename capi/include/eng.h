/* Eng for programs in C.
 *
 * A program is a checked text, a model is compiled once, and a simulation owns its state:
 *
 *     EngProgram *program = eng_load("engine.eng");
 *     EngModel *model = eng_model(program, "Engine");
 *     EngSimulation *simulation = eng_simulation(model);
 *     eng_set(...); eng_start(simulation); eng_advance(simulation, 0.01);
 *
 * Numbers are in SI units. A function that returns a pointer returns NULL after a failure; one that returns an int returns 0,
 * or 1 after a failure. eng_last_error() then has the message, with its place in the text. Texts are in UTF-8.
 *
 * The caller frees each object once. The order does not matter: a simulation keeps what it needs of its model. Threads may use
 * different simulations at the same time; one object belongs to one thread at a time. */
#ifndef ENG_H
#define ENG_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct EngProgram EngProgram;
typedef struct EngModel EngModel;
typedef struct EngSimulation EngSimulation;
typedef struct EngWatch EngWatch;
typedef struct EngCheckpoint EngCheckpoint;

/* The version of the library. */
const char *eng_version(void);
/* The message of the last failure in this thread, valid until the next failure in this thread. */
const char *eng_last_error(void);

/* Reads and checks a model's file with all that it uses from its folder. */
EngProgram *eng_load(const char *path);
/* Checks a text under a file name. */
EngProgram *eng_from_text(const char *name, const char *text);
/* Warnings and notes of the check, as `eng check` prints them; "" if there is none. */
const char *eng_warnings(const EngProgram *program);
void eng_free_program(EngProgram *program);

/* Compiles a model. */
EngModel *eng_model(const EngProgram *program, const char *name);
/* Compiles the model of an analysis. Its simulations have the parameters, steps and start of the analysis. */
EngModel *eng_analysis(const EngProgram *program, const char *name);
void eng_free_model(EngModel *model);

/* Parameters keep their values during a simulation. Indices begin at 0. Texts are valid as long as the model. */
size_t eng_parameter_count(const EngModel *model);
const char *eng_parameter_path(const EngModel *model, size_t index);
const char *eng_parameter_unit(const EngModel *model, size_t index);
int eng_parameter(const EngModel *model, const char *path, size_t *index);

/* Inputs change while a simulation runs. An input is a parameter, too: its start value. */
size_t eng_input_count(const EngModel *model);
const char *eng_input_path(const EngModel *model, size_t index);
const char *eng_input_unit(const EngModel *model, size_t index);
int eng_input(const EngModel *model, const char *path, size_t *index);

/* Channels are the numbers that a simulation gives. */
size_t eng_channel_count(const EngModel *model);
const char *eng_channel_path(const EngModel *model, size_t index);
const char *eng_channel_unit(const EngModel *model, size_t index);
int eng_channel(const EngModel *model, const char *path, size_t *index);

/* Prepares a simulation. Before eng_start: eng_set, eng_fixed_step, eng_tolerance. */
EngSimulation *eng_simulation(const EngModel *model);
void eng_free_simulation(EngSimulation *simulation);
int eng_set(EngSimulation *simulation, size_t parameter, double value);
/* Fixed steps (s). */
int eng_fixed_step(EngSimulation *simulation, double step);
/* Steps of a tolerance; the factor scales the physical tolerances, 1 is the default. */
int eng_tolerance(EngSimulation *simulation, double factor);
/* Assembles the model and starts. */
int eng_start(EngSimulation *simulation);
/* Continues from a checkpoint of the same model with the same parameters, in place of eng_start. */
int eng_resume(EngSimulation *simulation, const uint8_t *bytes, size_t size);

/* Time (s); not a number before the start. */
double eng_time(const EngSimulation *simulation);
/* Sets an input from the present time on. */
int eng_set_input(EngSimulation *simulation, size_t input, double value);
/* Value and rate that a `linear` or `cubic` input has at the end of the next eng_advance. The rate of a `linear` one is 0. */
int eng_aim_input(EngSimulation *simulation, size_t input, double value, double rate);
/* Steps up to a time (s), which no step crosses. */
int eng_advance(EngSimulation *simulation, double to);

/* Plans the reading of channels: only their elements are evaluated. */
EngWatch *eng_watch(EngSimulation *simulation, const size_t *channels, size_t count);
void eng_free_watch(EngWatch *watch);
/* Writes the values of the channels of a plan at the present state, in their order. */
int eng_values(EngSimulation *simulation, EngWatch *watch, double *values, size_t count);

/* The state as bytes. A simulation that continues from them gives the same bits as an uninterrupted one. */
EngCheckpoint *eng_checkpoint(EngSimulation *simulation);
const uint8_t *eng_checkpoint_bytes(const EngCheckpoint *checkpoint);
size_t eng_checkpoint_size(const EngCheckpoint *checkpoint);
void eng_free_checkpoint(EngCheckpoint *checkpoint);

#ifdef __cplusplus
}
#endif

#endif
