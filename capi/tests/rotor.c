/* A controller brings a rotor to a speed; then wrong calls, whose messages go to the output. */
#include "eng.h"
#include <stdio.h>
#include <stdlib.h>

static void failed(const char *what) {
    fprintf(stderr, "%s: %s\n", what, eng_last_error());
    exit(1);
}

static void refused(int status) {
    if (status == 0)
        exit(2);
    printf("refused: %s\n", eng_last_error());
}

int main(int count, char **words) {
    if (count != 2)
        return 3;
    EngProgram *program = eng_load(words[1]);
    if (!program)
        failed("load");
    EngModel *model = eng_model(program, "Rotor");
    if (!model)
        failed("model");
    size_t brake, speed, inertia;
    if (eng_input(model, "brake", &brake) || eng_channel(model, "speed", &speed) || eng_parameter(model, "inertia", &inertia))
        failed("names");
    printf("unit %s\n", eng_input_unit(model, brake));

    EngSimulation *simulation = eng_simulation(model);
    if (eng_set(simulation, inertia, 0.05) || eng_start(simulation))
        failed("start");
    EngWatch *watch = eng_watch(simulation, &speed, 1);
    double now;
    EngCheckpoint *saved = NULL;
    for (int step = 0; step < 100; step++) {
        if (eng_values(simulation, watch, &now, 1))
            failed("values");
        double torque = 0.5*(now - 60.0);
        torque = torque < 0.0 ? 0.0 : torque > 40.0 ? 40.0 : torque;
        if (eng_set_input(simulation, brake, torque) || eng_advance(simulation, 0.01*(step + 1)))
            failed("advance");
        if (step == 49)
            saved = eng_checkpoint(simulation);
        printf("%.17g %.17g\n", eng_time(simulation), now);
    }

    /* from the checkpoint the same bits */
    EngSimulation *second = eng_simulation(model);
    if (eng_set(second, inertia, 0.05) || eng_resume(second, eng_checkpoint_bytes(saved), eng_checkpoint_size(saved)))
        failed("resume");
    printf("resumed at %.17g\n", eng_time(second));
    for (int step = 50; step < 100; step++) {
        if (eng_values(second, watch, &now, 1))
            failed("values");
        double torque = 0.5*(now - 60.0);
        torque = torque < 0.0 ? 0.0 : torque > 40.0 ? 40.0 : torque;
        if (eng_set_input(second, brake, torque) || eng_advance(second, 0.01*(step + 1)))
            failed("advance");
    }
    double first, last;
    if (eng_values(simulation, watch, &first, 1) || eng_values(second, watch, &last, 1))
        failed("values");
    printf("end %.17g %.17g\n", first, last);

    refused(eng_channel(model, "sped", &speed));
    refused(eng_set(simulation, inertia, 0.1));
    refused(eng_set_input(simulation, brake, 80.0));
    refused(eng_set_input(simulation, 7, 1.0));
    refused(eng_advance(simulation, 0.5));
    refused(eng_values(simulation, watch, NULL, 1));
    refused(eng_advance(NULL, 2.0));
    refused(eng_load("no.eng") == NULL);

    eng_free_checkpoint(saved);
    eng_free_watch(watch);
    eng_free_program(program);
    eng_free_model(model);
    eng_free_simulation(simulation);
    eng_free_simulation(second);
    return 0;
}
